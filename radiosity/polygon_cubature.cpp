#include "radiosity/polygon_cubature.h"

#include <cassert>

#include "radiosity/gauss_rules.h"

namespace twopass {
namespace {

// Rows parallel to the edge a b that shrink towards the tip c.
void add_triangle(const V3d& a, const V3d& b, const V3d& c, const V3d& normal, int order, Cubature& cubature) {
  const GaussRule& along = gauss_legendre(order);
  const GaussRule& towards_tip = gauss_jacobi(order);
  const V3d u = b - a, v = c - a;
  const double twice_area = u.cross(v).dot(normal);
  for (int j = 0; j < order; ++j) {
    const double t = towards_tip.x[j], weight = twice_area * towards_tip.w[j];
    for (int i = 0; i < order; ++i)
      cubature.points[cubature.n++] = {a + u * ((1.0 - t) * along.x[i]) + v * t, weight * along.w[i]};
  }
}

// The parallelogram with the corner a and the edges u and v.
void add_parallelogram(const V3d& a, const V3d& u, const V3d& v, int order, Cubature& cubature) {
  const GaussRule& rule = gauss_legendre(order);
  const double area = u.cross(v).length();
  for (int j = 0; j < order; ++j)
    for (int i = 0; i < order; ++i)
      cubature.points[cubature.n++] = {a + u * rule.x[i] + v * rule.x[j], area * rule.w[i] * rule.w[j]};
}

// Equal to the last digits: then the two triangles' union has the same points twice as cheaply.
bool is_parallelogram(const Polygon& polygon) {
  if (polygon.n != 4) return false;
  const auto& v = polygon.v;
  const V3d u = v[1] - v[0], twist = (v[2] - v[3]) - u;
  return twist.length2() <= 1e-28 * (u.length2() + (v[3] - v[0]).length2());
}

}  // namespace

void make_cubature(const Polygon& polygon, const V3d& unit_normal, int order, Cubature& cubature) {
  assert(order >= 1 && order <= Cubature::max_order);
  cubature.n = 0;
  if (polygon.empty()) return;
  if (order == 1) {
    cubature.points[cubature.n++] = {polygon_centroid(polygon), polygon_area(polygon)};
    return;
  }
  const auto& v = polygon.v;
  if (is_parallelogram(polygon)) return add_parallelogram(v[0], v[1] - v[0], v[3] - v[0], order, cubature);
  for (int i = 1; i + 1 < polygon.n; ++i) add_triangle(v[0], v[i], v[i + 1], unit_normal, order, cubature);
}

}  // namespace twopass
