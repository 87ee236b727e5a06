// A small convex planar polygon in double precision: area, centroid, clipping. It knows nothing of light.
#pragma once

#include <array>

#include "render/core/types.h"

namespace twopass {

/// A convex planar polygon; its front is the side from which the vertices run counter-clockwise.
/// Three or four vertices come in; each clipping adds at most one, and nothing here clips one polygon more than
/// three times, so eight places are enough and nothing is allocated. `n` < 3 means empty.
struct Polygon {
  static constexpr int capacity = 8;

  std::array<V3d, capacity> v;
  int n = 0;

  bool empty() const { return n < 3; }
  const V3d& next(int i) const { return v[i + 1 == n ? 0 : i + 1]; }
};

/// The triangle a, b, c.
Polygon make_polygon(const V3d& a, const V3d& b, const V3d& c);
/// The quadrilateral a, b, c, d. REQUIRES: convex and planar (as well as its coordinates can say it).
Polygon make_polygon(const V3d& a, const V3d& b, const V3d& c, const V3d& d);

/// a b - c d with one rounding at the end, even when the products nearly cancel (Kahan; error bound 1.5 ulp).
double difference_of_products(double a, double b, double c, double d);
/// a x b with every component to 1.5 ulp.
V3d accurate_cross(const V3d& a, const V3d& b);

/// The vector that points out of the front and is as long as the area; zero for an empty or flat polygon.
V3d polygon_area_vector(const Polygon& polygon);
/// The area, >= 0.
double polygon_area(const Polygon& polygon);
/// The centre of area; the mean of the vertices when the area is zero. REQUIRES: n >= 1.
V3d polygon_centroid(const Polygon& polygon);
/// The largest distance of a vertex from `centre`.
double polygon_radius(const Polygon& polygon, const V3d& centre);

/// Largest absolute coordinate of the vertices; 0 without any. Rounding errors are in proportion to it.
double largest_coordinate(const Polygon& polygon);

/// The part of the polygon in front of (or in) the plane through `point` with the given normal, of any length.
/// Sutherland-Hodgman without a tolerance: a new vertex only where the signs strictly differ, so nothing is
/// ever divided by zero. Parts without at least three vertices strictly in front or on the plane, and polygons
/// that only touch the plane from behind, come out empty. REQUIRES: polygon.n < Polygon::capacity.
Polygon clip(const Polygon& polygon, const V3d& point, const V3d& normal);

/// True if the rounding of the coordinates (4 ulp of the largest one) could have moved every vertex of each
/// polygon off one common plane: such polygons exchange no light. Degenerate polygons count as coplanar with
/// everything.
bool are_coplanar(const Polygon& a, const Polygon& b);
/// True if no vertex is strictly in front of the plane through `point` with the given normal.
bool is_wholly_behind(const Polygon& polygon, const V3d& point, const V3d& normal);

}  // namespace twopass
