// Texture coordinates on shapes, and how positions change with them.
#pragma once

#include "render/scene/geometry.h"

namespace twopass {

struct Parametrization {
  V2f uv;
  V3f dp_du, dp_dv;  ///< never zero: any tangents where the coordinates have no derivatives
};

/// Texture coordinates at a point of a triangle; `barycentric` of corners 1 and 2.
inline V2f interpolated(const std::array<V2f, 3>& uvs, const V2f& barycentric) {
  return uvs[0] + (uvs[1] - uvs[0]) * barycentric.x + (uvs[2] - uvs[0]) * barycentric.y;
}
/// How far u and v go along a unit of length where they change fastest.
inline V2f rate_of(const Parametrization& p) { return {1.0f / p.dp_du.length(), 1.0f / p.dp_dv.length()}; }

/// With any tangents. `normal`: unit, of the front.
Parametrization any_parametrization(const V2f& uv, const V3f& normal);
/// At a point of a triangle with these texture coordinates at its corners, `barycentric` of corners 1 and 2.
Parametrization parametrization(const std::array<V3f, 3>& corners, const std::array<V2f, 3>& uvs,
                                const V2f& barycentric, const V3f& normal);
/// The same of a mesh. One without texture coordinates has these
/// in their place.
Parametrization parametrization(const Mesh& mesh, std::uint32_t triangle, const V2f& barycentric,
                                const V3f& normal);
/// At the point of a sphere where its front has the unit normal `normal`.
Parametrization parametrization(const Sphere& sphere, const V3f& normal);
/// At a point of a disk or cylinder.
Parametrization parametrization(const Disk& disk, const V3f& position);
Parametrization parametrization(const Cylinder& cylinder, const V3f& position);

/// Barycentric coordinates of corners 1 and 2 of the point of the triangle's plane nearest to `position`.
V2f barycentric_at(const std::array<V3f, 3>& triangle, const V3f& position);

}  // namespace twopass
