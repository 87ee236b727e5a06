// A scene file of any supported format to a SceneDescription and the settings that the file asks for.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "render/image/filter.h"
#include "render/load/texture_files.h"
#include "render/scene/scene.h"

namespace twopass {

/// What the file says about the picture. Unset: the file is silent, or its format has no such thing.
struct FileSettings {
  int width = 768, height = 576;
  Filter filter;                          ///< gaussian unless the file says otherwise
  std::optional<bool> half;               ///< component_format float16 (true) or float32 (false)
  std::optional<std::string> integrator;  ///< as named in the file
  int max_depth = -1;                     ///< path edges; -1 unlimited, 1 emitted light only, 2 direct light
  int rr_depth = 5;                       ///< path edges before Russian roulette starts
  bool hide_emitters = false;
  std::optional<int> samples_per_pixel;
  std::optional<std::uint32_t> seed;
};

struct LoadedScene {
  SceneDescription scene;
  FileSettings settings;
  std::vector<std::string> notes;  ///< one line each, for stderr: what was replaced or repaired, and why
};

/// Mitsuba XML parameters given on the command line (-D name=value).
using Definitions = std::map<std::string, std::string>;

/// Loads by extension: .xml Mitsuba, .obj Wavefront, .gltf and .glb glTF 2.0. Throws Error (file:line) for what
/// cannot be read, is malformed or is not supported, naming what is.
LoadedScene load_scene(const std::filesystem::path& path, const Definitions& definitions,
                       const TextureOptions& textures = {});

}  // namespace twopass
