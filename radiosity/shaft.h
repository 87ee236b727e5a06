// The convex hull of two triangles: what can come between them must reach into it.
#pragma once

#include "radiosity/polygon.h"

namespace twopass {

/// The smallest box around a polygon's vertices.
Imath::Box3d bounds_of(const Polygon& polygon);

/// The hull of two convex polygons that face each other. Its planes are those of the polygons and those through
/// an edge of one and a vertex of the other that have everything on one side (E. Haines and J. Wallace, "Shaft
/// culling for efficient ray-traced radiosity", 1991, with triangles in place of boxes).
class Shaft {
 public:
  /// `rounding` is the distance that coordinates cannot tell from 0. REQUIRES: each polygon in front of the
  /// other's plane, neither degenerate.
  Shaft(const Polygon& a, const Polygon& b, double rounding);

  /// The part of a triangle inside the hull; empty if it only touches the hull or has both polygons on one
  /// side. Never less than the true part but for `rounding`: a plane too many to be kept only makes it larger.
  [[nodiscard]] Polygon part_inside(const Polygon& triangle) const;
  [[nodiscard]] const Imath::Box3d& bounds() const { return bounds_; }

 private:
  struct Plane {
    V3d point, normal;  // unit, into the hull
  };
  void add_planes_between(const Polygon& edges, const Polygon& vertices);
  void add_plane_if_supporting(const V3d& point, const V3d& normal);
  [[nodiscard]] bool is_to_one_side(const Polygon& triangle) const;

  static constexpr int most_planes = 2 + 2 * Polygon::capacity * Polygon::capacity;

  const Polygon a_, b_;
  Imath::Box3d bounds_;
  double rounding_;
  std::array<Plane, most_planes> plane_;
  int planes_ = 0;
};

}  // namespace twopass
