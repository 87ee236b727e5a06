// The options that name a scene and override what its file says.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "render/console.h"
#include "render/load/load.h"

namespace twopass {

struct SceneOptions {
  std::string file;
  std::vector<std::string> definitions;  ///< name=value
  std::vector<double> camera;            ///< origin, target, up: 9 numbers
  std::optional<double> fov_degrees;
  std::vector<float> sky;  ///< R, G, B
  std::string envmap;      ///< file
  bool ignore_unsupported = false;
  TextureOptions textures;

  /// What a scene that has none of it gets: a sky, and a camera that frames it.
  enum class Additions { none, light, light_and_camera };

  /// The file and the parameters of its contents; `add_sky_to` adds the sky, `add_view_to` the camera.
  void add_to(CLI::App& command);
  void add_sky_to(CLI::App& command);
  void add_view_to(CLI::App& command);
  /// Loads the scene, applies the options, and says on the console what was noticed. What is to be seen, that
  /// is with additions, is `centred`; else coordinates are those of the file. Colour spaces of textures are
  /// those of the configuration, as in DisplayOptions. Throws Error.
  [[nodiscard]] LoadedScene load(const Console& console, Additions additions,
                                 const std::string& color_config) const;
};

/// Says what was wrong with textures that were read while rendering.
void note_tiled_textures(const Console& console, std::span<const TiledTexture> textures);

}  // namespace twopass
