// <texture> elements to textures; their images are read once however often they are used.
#pragma once

#include <map>
#include <optional>
#include <tuple>

#include "materials/texture.h"
#include "render/load/mitsuba_properties.h"
#include "render/load/notes.h"

namespace twopass {

class MitsubaTextures {
 public:
  /// REQUIRES: the arguments outlive this.
  MitsubaTextures(const MitsubaTree& tree, Notes& notes) : tree_(tree), notes_(notes) {}

  /// The texture of a <texture>. Colours are limited to what `use` allows. Throws Error with file:line.
  Texture of(const XmlNode& texture, ColorUse use);
  /// A property that may be a colour or a texture; nothing where it is not given.
  std::optional<Texture> property(Properties& p, std::string_view name, ColorUse use);

 private:
  Texture read_bitmap(Properties& p, ColorUse use);
  Texture read_checkerboard(Properties& p, ColorUse use);
  std::shared_ptr<const Image> image(const std::filesystem::path& path, const std::string& where, bool raw,
                                     ColorUse use);

  const MitsubaTree& tree_;
  Notes& notes_;
  std::map<std::tuple<std::filesystem::path, bool, ColorUse>, std::shared_ptr<const Image>> images_;
};

}  // namespace twopass
