// A piece of surface to send rays from and to measure form factors of: a flat triangle or a spherical one.
#pragma once

#include <array>

#include "radiosity/polygon.h"
#include "render/scene/shape.h"

namespace twopass {

/// A point of an element: what a ray needs to start there.
struct ElementPoint {
  V3d position;
  V3d normal;    ///< unit, on the element's side
  float offset;  ///< how far along the normal a ray must start to clear rounding errors
  /// The start of a ray, or the end of a shadow ray, on the element's side.
  [[nodiscard]] V3f ray_position() const { return V3f(position + normal * offset); }
};

/// The geometry of an element, or of a whole triangle: flat, or a piece of a sphere.
struct Patch {
  std::array<V3d, 3> corner;  ///< counter-clockwise seen from the patch's side
  V3d normal{0.0};            ///< of the flat triangle, unit; zero if it has no area
  double area = 0.0;          ///< of the true surface
  float offset = 0.0f;        ///< as in ElementPoint
  bool on_sphere = false;
  V3d center{0.0};             ///< of the sphere
  double signed_radius = 0.0;  ///< of the sphere; negative: the patch is seen from inside

  /// The flat triangle.
  [[nodiscard]] Polygon polygon() const { return make_polygon(corner[0], corner[1], corner[2]); }
  /// Point uniform in area of the true surface for u uniform in the unit square.
  [[nodiscard]] ElementPoint sample(const V2f& u) const;
  /// The point in the middle.
  [[nodiscard]] ElementPoint centroid() const;

 private:
  [[nodiscard]] ElementPoint on_sphere_towards(const V3d& outward) const;
};

/// A side of a whole triangle.
Patch triangle_patch(const Mesh& mesh, std::uint32_t triangle, Side side);

/// The corners of an octant of the unit sphere, counter-clockwise seen from outside. Bit k of `octant` (0 to 7)
/// is the sign of coordinate k; corner 0 is on the x axis.
std::array<V3d, 3> octant_corners(std::uint32_t octant);
/// A side of the spherical triangle between three directions of unit length, counter-clockwise seen from
/// outside.
Patch spherical_patch(const Sphere& sphere, const std::array<V3d, 3>& direction, Side side);

}  // namespace twopass
