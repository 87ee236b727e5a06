// Primitives of a glTF mesh to triangle meshes in the mesh's own coordinates.
#pragma once

#include <optional>

#include "render/load/gltf_document.h"
#include "render/scene/shape.h"

namespace twopass {

/// What was read of meshes and what was left out, to be told once.
struct GltfLosses {
  std::size_t not_triangles = 0;  ///< primitives made of points or lines
  std::size_t bad_indices = 0;    ///< triangles that refer to vertices that are not there
  std::size_t not_finite = 0;     ///< triangles with NaN, infinite or huge coordinates
  std::size_t without_area = 0;   ///< triangles
  std::size_t morph_targets = 0;  ///< primitives that have some: they stay in their default pose
  std::size_t corners = 0;        ///< of all triangles that were looked at: what the work is measured by
};

/// A primitive with what a material may ask for.
struct GltfPrimitive {
  Mesh mesh;                  ///< without texture coordinates
  std::vector<V2f> uvs[2];    ///< TEXCOORD_0 and _1, one a position, or empty
  std::vector<C3f> colors;    ///< COLOR_0, linear, in [0, 1], one a position, or empty
  std::vector<float> alphas;  ///< of COLOR_0 where it has them
};

/// Reads one primitive; only vertices that triangles use are kept. Nothing when no triangle is left. `name`: of
/// the mesh, for errors. Throws Error when an accessor is unfit.
std::optional<GltfPrimitive> read_gltf_primitive(const GltfDocument& document,
                                                 const tinygltf::Primitive& primitive, const std::string& name,
                                                 GltfLosses& losses);

}  // namespace twopass
