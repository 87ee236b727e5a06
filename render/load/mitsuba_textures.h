// <texture> elements to textures.
#pragma once

#include <optional>

#include "materials/texture.h"
#include "render/load/mitsuba_properties.h"
#include "render/load/texture_files.h"

namespace twopass {

class MitsubaTextures {
 public:
  /// REQUIRES: the arguments outlive this.
  MitsubaTextures(const MitsubaTree& tree, TextureFiles& files) : tree_(tree), files_(files) {}

  /// The texture of a <texture>. Colours are limited to what `use` allows. Throws Error with file:line.
  Texture of(const XmlNode& texture, ColorUse use);
  /// A property that may be a colour or a texture; nothing where it is not given.
  std::optional<Texture> property(Properties& p, std::string_view name, ColorUse use);

 private:
  Texture read_bitmap(Properties& p, ColorUse use);
  Texture read_checkerboard(Properties& p, ColorUse use);
  Texture read_scale(Properties& p, ColorUse use);
  Texture read_mesh_attribute(Properties& p, ColorUse use);

  const MitsubaTree& tree_;
  TextureFiles& files_;
};

}  // namespace twopass
