#include "radiosity/polygon.h"

#include <cassert>

namespace twopass {

Polygon make_polygon(const V3d& a, const V3d& b, const V3d& c) {
  Polygon polygon;
  polygon.v[0] = a;
  polygon.v[1] = b;
  polygon.v[2] = c;
  polygon.n = 3;
  return polygon;
}

Polygon make_polygon(const V3d& a, const V3d& b, const V3d& c, const V3d& d) {
  Polygon polygon = make_polygon(a, b, c);
  polygon.v[3] = d;
  polygon.n = 4;
  return polygon;
}

double difference_of_products(double a, double b, double c, double d) {
  const double cd = c * d;
  return std::fma(a, b, -cd) + std::fma(-c, d, cd);
}

V3d accurate_cross(const V3d& a, const V3d& b) {
  // On x86-64-v2 std::fma is a call, and only nearly parallel vectors need it.
  const V3d plain = a.cross(b);
  if (plain.length2() > 1e-3 * a.length2() * b.length2()) return plain;
  return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
          difference_of_products(a.x, b.y, a.y, b.x)};
}

V3d polygon_area_vector(const Polygon& polygon) {
  const auto& v = polygon.v;
  if (polygon.n == 4) return accurate_cross(v[2] - v[0], v[3] - v[1]) * 0.5;
  V3d sum(0.0);
  for (int i = 1; i + 1 < polygon.n; ++i) sum += accurate_cross(v[i] - v[0], v[i + 1] - v[0]);
  return sum * 0.5;
}

double polygon_area(const Polygon& polygon) { return polygon_area_vector(polygon).length(); }

V3d polygon_centroid(const Polygon& polygon) {
  const auto& v = polygon.v;
  // Everything relative to the first vertex, so that a polygon far from the origin keeps its digits.
  V3d mean(0.0);
  for (int i = 1; i < polygon.n; ++i) mean += v[i] - v[0];
  if (polygon.n <= 3) return v[0] + mean / polygon.n;
  const V3d area_vector = polygon_area_vector(polygon);
  V3d moment(0.0);
  double weight = 0.0;
  for (int i = 1; i + 1 < polygon.n; ++i) {
    const V3d p = v[i] - v[0], q = v[i + 1] - v[0];
    const double w = p.cross(q).dot(area_vector);
    moment += (p + q) * (w / 3.0);
    weight += w;
  }
  return weight > 0.0 ? v[0] + moment / weight : v[0] + mean / polygon.n;
}

double polygon_radius(const Polygon& polygon, const V3d& centre) {
  double largest = 0.0;
  for (int i = 0; i < polygon.n; ++i) largest = std::max(largest, (polygon.v[i] - centre).length2());
  return std::sqrt(largest);
}

Polygon clip(const Polygon& polygon, const V3d& point, const V3d& normal) {
  assert(polygon.n < Polygon::capacity);
  std::array<double, Polygon::capacity> d;
  bool any_in_front = false;
  for (int i = 0; i < polygon.n; ++i) {
    d[i] = normal.dot(polygon.v[i] - point);
    any_in_front |= d[i] > 0.0;
  }
  Polygon kept;
  if (!any_in_front) return kept;
  int cuts = 0;  // a convex polygon has two; more come from rounding alone and would only add vertices
  for (int i = 0; i < polygon.n; ++i) {
    const int j = i + 1 == polygon.n ? 0 : i + 1;
    if (d[i] >= 0.0) kept.v[kept.n++] = polygon.v[i];
    const bool signs_differ = (d[i] > 0.0 && d[j] < 0.0) || (d[i] < 0.0 && d[j] > 0.0);
    if (signs_differ && ++cuts <= 2) {
      // From the vertex in front, whichever way the edge runs: two polygons that share the edge get the same
      // point.
      const int front = d[i] > 0.0 ? i : j, back = d[i] > 0.0 ? j : i;
      const double t = d[front] / (d[front] - d[back]);
      kept.v[kept.n++] = polygon.v[front] + (polygon.v[back] - polygon.v[front]) * t;
    }
  }
  if (kept.n < 3) kept.n = 0;
  return kept;
}

namespace {

// Whether every vertex of b lies in the plane of a, as far as the coordinates' last bits can tell. A plane
// through points that may each be `error` off is uncertain by error * (1 + distance / altitude) at that
// distance from them.
bool lies_in_plane_of(const Polygon& b, const Polygon& a, double error) {
  const V3d area_vector = polygon_area_vector(a);
  const double area = area_vector.length();
  if (!(area > 0.0)) return true;
  const double extent = polygon_radius(a, a.v[0]);
  for (int i = 0; i < b.n; ++i) {
    const V3d w = b.v[i] - a.v[0];
    if (std::abs(w.dot(area_vector)) > error * (area + extent * w.length())) return false;
  }
  return true;
}

}  // namespace

double largest_coordinate(const Polygon& polygon) {
  double largest = 0.0;
  for (int i = 0; i < polygon.n; ++i)
    for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(polygon.v[i][axis]));
  return largest;
}

bool are_coplanar(const Polygon& a, const Polygon& b) {
  const double largest = std::max(largest_coordinate(a), largest_coordinate(b));
  const double error = 4.0 * std::numeric_limits<double>::epsilon() * largest;
  return lies_in_plane_of(b, a, error) && lies_in_plane_of(a, b, error);
}

bool is_wholly_behind(const Polygon& polygon, const V3d& point, const V3d& normal) {
  for (int i = 0; i < polygon.n; ++i)
    if (normal.dot(polygon.v[i] - point) > 0.0) return false;
  return true;
}

}  // namespace twopass
