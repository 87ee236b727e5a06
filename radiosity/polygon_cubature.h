// Integration points on a convex polygon: Gauss's rules carried over to triangles and quadrilaterals.
#pragma once

#include "radiosity/polygon.h"

namespace twopass {

/// A point of the polygon and the share of the area it stands for (> 0).
struct CubaturePoint {
  V3d p;
  double area;
};

/// Points for Int f dA ~ Sum area f(p). Allocation-free: room for the largest order on the largest polygon.
struct Cubature {
  static constexpr int max_order = 10;
  static constexpr int capacity = (Polygon::capacity - 2) * max_order * max_order;

  std::array<CubaturePoint, capacity> points;
  int n = 0;
};

/// Fills `cubature` with `order` x `order` points on a parallelogram and on every triangle that another polygon
/// is cut into; order 1 is the centroid alone. Exact for polynomials of degree 2 order - 1. REQUIRES: 1 <=
/// order <= Cubature::max_order; `unit_normal` is that of the polygon's front.
void make_cubature(const Polygon& polygon, const V3d& unit_normal, int order, Cubature& cubature);

}  // namespace twopass
