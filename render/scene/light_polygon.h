// The convex polygons that a mesh's triangles form: what next-event estimation samples as a whole.
#pragma once

#include <array>
#include <vector>

#include "render/scene/geometry.h"

namespace twopass {

/// A planar convex polygon of three or four corners, counter-clockwise seen from its front.
struct LightPolygon {
  std::array<V3f, 4> corner;               ///< `corners` of them
  std::array<std::uint32_t, 2> triangles;  ///< of the mesh; `corners` - 2 of them
  int corners = 0;
  bool is_parallelogram = false;
  V3d normal{0.0};           ///< unit, of the front
  double area = 0.0;         ///< > 0
  float pdf_a = 0.0f;        ///< 1 / area
  float offset = 0.0f;       ///< rounding_offset() of its corners
  V3f middle{0.0f};          ///< mean of the corners
  float reach2 = 0.0f;       ///< squared distance of the farthest corner from there
  float first_share = 1.0f;  ///< of the area: the triangle of the first three corners
  /// Of a parallelogram: p = corner[0] + s (corner[1] - corner[0]) + t (corner[3] - corner[0]) has
  /// s = (p - corner[0]).dot(dual1), and t likewise.
  V3f dual1{0.0f}, dual2{0.0f};
};

/// Triangles without area are left out. Two triangles with a common edge become one polygon if they are
/// coplanar and it is convex to rounding; parallelograms are formed first.
std::vector<LightPolygon> light_polygons(const Mesh& mesh);

}  // namespace twopass
