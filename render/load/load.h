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

/// A part of a picture, in its pixels.
struct PixelWindow {
  V2i corner;  ///< upper left
  V2i size;
};

/// What the file says about the picture. Unset: the file is silent, or its format has no such thing.
struct FileSettings {
  int width = 768, height = 576;
  std::optional<PixelWindow> crop;        ///< the part of it that is wanted; lies within it
  Filter filter;                          ///< gaussian unless the file says otherwise
  std::optional<bool> half;               ///< component_format float16 (true) or float32 (false)
  std::optional<std::string> integrator;  ///< as named in the file
  int max_depth = -1;                     ///< path edges; -1 unlimited, 1 emitted light only, 2 direct light
  int rr_depth = 5;                       ///< path edges before Russian roulette starts
  bool hide_emitters = false;
  std::optional<int> samples_per_pixel;
  std::optional<std::uint32_t> seed;
};

/// Something that is left out, and why.
struct Skipped {
  std::string what, why;
};

struct LoadedScene {
  SceneDescription scene;
  FileSettings settings;
  std::vector<TiledTexture> tiled_textures;
  std::vector<Skipped> left_out;   ///< what is not supported, where that was to be ignored
  std::vector<std::string> notes;  ///< one line each, for stderr: what was replaced or repaired, and why
};

/// Mitsuba XML parameters given on the command line (-D name=value).
using Definitions = std::map<std::string, std::string>;

/// Loads by extension: .xml Mitsuba, .obj Wavefront, .gltf and .glb glTF 2.0. Throws Error (file:line) for what
/// cannot be read, is malformed or is not supported, naming what is; with `ignore_unsupported`, features of a
/// Mitsuba scene that are not supported are left out.
LoadedScene load_scene(const std::filesystem::path& path, const Definitions& definitions,
                       const TextureOptions& textures = {}, bool ignore_unsupported = false);

}  // namespace twopass
