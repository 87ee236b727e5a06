// A piece of surface to send rays from and to measure form factors of: a flat triangle, or what is above one on
// a sphere, disk or cylinder.
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

/// The geometry of an element, or of a whole triangle: flat, or a piece of an analytic surface.
struct Patch {
  std::array<V3d, 3> corner;  ///< counter-clockwise seen from the patch's side
  V3d normal{0.0};            ///< of the flat triangle, unit; zero if it has no area
  double area = 0.0;          ///< of the true surface
  float offset = 0.0f;        ///< as in ElementPoint
  bool on_sphere = false;
  V3d center{0.0};             ///< of the sphere
  double signed_radius = 0.0;  ///< of the sphere; negative: the patch is seen from inside
  /// The surface, if it is one of these, and the corners' parameters on it (parametric_patch()).
  const Disk* disk = nullptr;
  const Cylinder* cylinder = nullptr;
  std::array<V2d, 3> parameter{};
  Side side = front;

  /// The true surface is not, or not exactly, the flat triangle.
  [[nodiscard]] bool is_analytic() const { return on_sphere || disk || cylinder; }
  /// The flat triangle.
  [[nodiscard]] Polygon polygon() const { return make_polygon(corner[0], corner[1], corner[2]); }
  /// Point uniform in area of the true surface for u uniform in the unit square.
  [[nodiscard]] ElementPoint sample(const V2f& u) const;
  /// The point in the middle.
  [[nodiscard]] ElementPoint centroid() const;
  /// The point of the true surface with barycentric coordinates b of corners 1 and 2: of their parameters on a
  /// disk or cylinder, else of the flat triangle.
  [[nodiscard]] ElementPoint at(const V2f& b) const;
  /// The point of the true surface above a point of the flat triangle.
  [[nodiscard]] ElementPoint above(const V3d& flat) const;

 private:
  [[nodiscard]] ElementPoint on_sphere_towards(const V3d& outward) const;
};

/// A side of a whole triangle.
Patch triangle_patch(const std::array<V3f, 3>& corners, Side side);
Patch triangle_patch(const Mesh& mesh, std::uint32_t triangle, Side side);

/// The corners of an octant of the unit sphere, counter-clockwise seen from outside. Bit k of `octant` (0 to 7)
/// is the sign of coordinate k; corner 0 is on the x axis.
std::array<V3d, 3> octant_corners(std::uint32_t octant);
/// A side of the spherical triangle between three directions of unit length, counter-clockwise seen from
/// outside.
Patch spherical_patch(const Sphere& sphere, const std::array<V3d, 3>& direction, Side side);

/// The points of a disk and of a cylinder with given parameters. A disk's are the square from -1 to 1, of which
/// it is the concentric image; a cylinder's are turns around its axis and the way along it, both from 0 to 1.
/// Equal areas of parameters are equal areas of the surface.
V3d point_of(const Disk& disk, const V2d& parameter);
V3d point_of(const Cylinder& cylinder, const V2d& parameter);
/// A side of the piece of a disk or cylinder over a triangle of parameters, counter-clockwise seen from the
/// front. REQUIRES: the surface outlives the patch.
Patch parametric_patch(const Disk& disk, const std::array<V2d, 3>& parameter, Side side);
Patch parametric_patch(const Cylinder& cylinder, const std::array<V2d, 3>& parameter, Side side);

}  // namespace twopass
