// glTF materials onto `principled`, and what they emit.
//
// roughness and metallic mean the same on both sides: alpha = roughness^2, a dielectric of index 1.5 (or
// KHR_materials_ior) blended into a metal of the base colour. Opaque materials answer on both sides whether
// they are doubleSided or not, as in Blender's Cycles: a path tracer that culls back faces would let light
// through walls, and one that shades them black punishes careless winding. doubleSided decides which sides
// emit.
#pragma once

#include <array>
#include <map>
#include <memory>

#include "render/load/gltf_textures.h"
#include "render/load/notes.h"
#include "render/scene/scene.h"

namespace twopass {

/// The attribute of meshes that holds COLOR_0: materials refer to it, and are bound to it by bind_mesh_colors.
inline constexpr const char* gltf_vertex_colors = "vertex_color";

/// What the vertices of a primitive bring along, as far as it changes the material.
struct GltfVertexData {
  bool colors = false;    ///< COLOR_0 multiplies the base colour
  bool mirrored = false;  ///< texture coordinates run clockwise: bumps would come out as dents
  auto operator<=>(const GltfVertexData&) const = default;
};

/// A material as shapes carry it.
struct GltfSurface {
  std::uint32_t material = 0;                         ///< index into SceneDescription::materials
  std::array<C3f, 2> radiance{C3f(0.0f), C3f(0.0f)};  ///< of Shape; of the front alone
  bool both_sides_emit = false;                       ///< the back the same
  std::shared_ptr<const Texture> radiance_texture{};  ///< of Shape
  int uv_set = 0;                                     ///< the texture coordinates that its textures use
};

class GltfMaterials {
 public:
  /// Adds materials to the scene. REQUIRES: the arguments outlive this.
  GltfMaterials(const GltfDocument& document, GltfTextures& textures, SceneDescription& scene, Notes& notes)
      : document_(document), textures_(textures), scene_(scene), notes_(notes) {}

  /// Material `index` of the file, the specification's default one for -1, made once for each kind of vertices.
  /// `user`: who refers to it, for errors.
  const GltfSurface& of(int index, const GltfVertexData& vertices, const std::string& user);

 private:
  const GltfDocument& document_;
  GltfTextures& textures_;
  SceneDescription& scene_;
  Notes& notes_;
  std::map<std::pair<int, GltfVertexData>, GltfSurface> made_;
};

}  // namespace twopass
