// Texture coordinates on shapes, and how positions change with them.
#pragma once

#include "render/scene/geometry.h"

namespace twopass {

struct Parametrization {
  V2f uv;
  V3f dp_du, dp_dv;  ///< never zero: any tangents where the coordinates have no derivatives
};

/// At a point of a triangle, `barycentric` of its corners 1 and 2. A mesh without texture coordinates has these
/// in their place. `normal`: unit, of the front.
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
