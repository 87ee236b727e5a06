// What is worth knowing of a mesh before it is rendered: for `info`, and for cameras that frame a model.
#pragma once

#include <span>

#include "render/scene/shape.h"

namespace twopass {

struct MeshFacts {
  double area = 0.0;
  std::size_t degenerate = 0;  ///< triangles without area
  std::size_t duplicates = 0;  ///< triangles on the same three points as another
  std::size_t open_edges = 0;  ///< edges of one triangle only: the mesh has holes, or is a sheet
  std::size_t turned_edges =
      0;  ///< edges that two triangles run along in the same sense: they face different ways
  std::size_t crowded_edges = 0;  ///< edges of more than two triangles
  double signed_volume = 0.0;     ///< enclosed, for a closed mesh; negative: its front is inside
  /// Whether every edge has exactly two triangles that face the same way.
  [[nodiscard]] bool is_closed() const {
    return area > 0.0 && open_edges == 0 && turned_edges == 0 && crowded_edges == 0;
  }
};

/// Vertices at the same position count as one, so that seams of textures and normals are no holes.
/// O(n log n) for n triangles.
MeshFacts facts_of(const Mesh& mesh);

/// Whether the meshes look like a room: seen from the middle of their common bounds, more of their surface (by
/// solid volume) shows its front than its back, by at least a quarter of the box. O(n).
bool faces_inward(std::span<const Shape> shapes);

}  // namespace twopass
