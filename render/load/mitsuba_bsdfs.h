// <bsdf> elements to materials.
#pragma once

#include <map>

#include "materials/material.h"
#include "render/load/mitsuba_textures.h"

namespace twopass {

/// The materials of a scene, each <bsdf> once however often it is referenced.
class MitsubaMaterials {
 public:
  /// REQUIRES: the arguments outlive this.
  MitsubaMaterials(const MitsubaTree& tree, std::vector<Material>& materials, MitsubaTextures& textures)
      : tree_(tree), materials_(materials), textures_(textures) {}

  /// The index of a <bsdf>'s material. Throws Error with file:line for what is not supported.
  std::uint32_t of(const XmlNode& bsdf);
  /// The material of shapes that have none: diffuse, reflecting half of the light, or nothing where they emit.
  std::uint32_t standard(bool emits);

 private:
  std::uint32_t add(Material material);

  const MitsubaTree& tree_;
  std::vector<Material>& materials_;
  MitsubaTextures& textures_;
  std::map<const XmlNode*, std::uint32_t> index_;
  std::map<bool, std::uint32_t> standard_;
};

}  // namespace twopass
