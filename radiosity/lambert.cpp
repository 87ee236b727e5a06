#include "radiosity/lambert.h"

namespace twopass {
namespace {

// Vertices seen from the receiving point, and the edges that start at them. The edges are kept apart because
// the difference of two rounded vertices far away would have lost the digits that the edge still has.
struct Outline {
  // Vertices within rounding of the horizon may make a convex polygon cross it more than twice.
  static constexpr int capacity = 2 * Polygon::capacity;

  std::array<V3d, capacity> vertex;
  std::array<V3d, capacity> edge;
  std::array<bool, capacity> sinks;  // the outline meets the horizon here and follows it to the next vertex
  int n = 0;

  const V3d& next(int i) const { return vertex[i + 1 == n ? 0 : i + 1]; }
  void add(const V3d& v, const V3d& e, bool sinks_here = false) {
    vertex[n] = v;
    edge[n] = e;
    sinks[n] = sinks_here;
    ++n;
  }
};

// The part of the polygon above the horizon n.v = 0. Signs must strictly differ before anything is cut.
Outline above_horizon(const V3d& p, const V3d& n, const Polygon& polygon) {
  std::array<V3d, Polygon::capacity> v;
  std::array<double, Polygon::capacity> height;
  for (int i = 0; i < polygon.n; ++i) {
    v[i] = polygon.v[i] - p;
    height[i] = n.dot(v[i]);
  }
  Outline outline;
  for (int i = 0; i < polygon.n; ++i) {
    const int j = i + 1 == polygon.n ? 0 : i + 1;
    const V3d e = polygon.v[j] - polygon.v[i];
    if (height[i] >= 0.0 && height[j] >= 0.0) {
      outline.add(v[i], e);
    } else if (height[i] >= 0.0) {
      const double t = height[i] / (height[i] - height[j]);
      outline.add(v[i], e * t);
      outline.add(v[i] + e * t, V3d(0.0), true);
    } else if (height[j] > 0.0) {
      const double t = height[j] / (height[j] - height[i]);
      outline.add(v[j] - e * t, e * t);
    }
  }
  for (int i = 0; i < outline.n; ++i)
    if (outline.sinks[i]) outline.edge[i] = outline.next(i) - outline.vertex[i];
  return outline;
}

}  // namespace

double signed_point_form_factor(const V3d& p, const V3d& n, const Polygon& source) {
  const Outline outline = above_horizon(p, n, source);
  if (outline.n < 3) return 0.0;
  double sum = 0.0;
  for (int i = 0; i < outline.n; ++i) {
    const V3d& a = outline.vertex[i];
    const V3d& b = outline.next(i);
    const V3d& e = outline.edge[i];
    // a x b = a x e. The shorter factor has the fewer digits to lose: e far away, b near a vertex.
    const V3d cross = accurate_cross(a, e.length2() < std::min(a.length2(), b.length2()) ? e : b);
    const double length = cross.length(), dot = a.dot(b);
    if (length > 0.0)
      sum -= n.dot(cross) / length * std::atan2(length, dot);
    else if (dot > 0.0)
      sum -= n.dot(cross) /
             dot;  // the limit of atan2(x, dot) / x; on the edge itself (dot < 0) the edge adds nothing
  }
  return sum / (2.0 * pi);
}

double point_form_factor(const V3d& p, const V3d& n, const Polygon& source) {
  if (source.empty()) return 0.0;
  if (!(polygon_area_vector(source).dot(p - source.v[0]) > 0.0)) return 0.0;
  return std::clamp(signed_point_form_factor(p, n, source), 0.0, 1.0);
}

}  // namespace twopass
