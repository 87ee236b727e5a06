#include "radiosity/shaft.h"

namespace twopass {

namespace {

struct Heights {
  double lowest = std::numeric_limits<double>::infinity(), highest = -std::numeric_limits<double>::infinity();
  void add(const Polygon& polygon, const V3d& point, const V3d& normal) {
    for (int i = 0; i < polygon.n; ++i) {
      const double height = normal.dot(polygon.v[i] - point);
      lowest = std::min(lowest, height);
      highest = std::max(highest, height);
    }
  }
};

}  // namespace

Imath::Box3d bounds_of(const Polygon& polygon) {
  Imath::Box3d bounds;
  for (int i = 0; i < polygon.n; ++i) bounds.extendBy(polygon.v[i]);
  return bounds;
}

Shaft::Shaft(const Polygon& a, const Polygon& b, double rounding) : a_(a), b_(b), rounding_(rounding) {
  bounds_ = bounds_of(a);
  bounds_.extendBy(bounds_of(b));
  plane_[planes_++] = {a.v[0], polygon_area_vector(a).normalized()};
  plane_[planes_++] = {b.v[0], polygon_area_vector(b).normalized()};
  add_planes_between(a, b);
  add_planes_between(b, a);
}

void Shaft::add_planes_between(const Polygon& edges, const Polygon& vertices) {
  for (int i = 0; i < edges.n; ++i) {
    const V3d edge = edges.next(i) - edges.v[i];
    for (int j = 0; j < vertices.n; ++j) {
      const V3d across = vertices.v[j] - edges.v[i], normal = accurate_cross(edge, across);
      // A plane through three points nearly in line is not worth its uncertainty.
      if (normal.length2() > 1e-12 * edge.length2() * across.length2())
        add_plane_if_supporting(edges.v[i], normal.normalized());
    }
  }
}

void Shaft::add_plane_if_supporting(const V3d& point, const V3d& normal) {
  Heights heights;
  heights.add(a_, point, normal);
  heights.add(b_, point, normal);
  if (heights.lowest >= -rounding_)
    plane_[planes_++] = {point, normal};
  else if (heights.highest <= rounding_)
    plane_[planes_++] = {point, -normal};
}

bool Shaft::is_to_one_side(const Polygon& triangle) const {
  const V3d normal = polygon_area_vector(triangle).normalized();
  Heights heights;
  heights.add(a_, triangle.v[0], normal);
  heights.add(b_, triangle.v[0], normal);
  return heights.lowest >= -rounding_ || heights.highest <= rounding_;
}

Polygon Shaft::part_inside(const Polygon& triangle) const {
  if (is_to_one_side(triangle)) return {};
  Polygon part = triangle;
  for (int k = 0; k < planes_ && !part.empty(); ++k) {
    Heights heights;
    heights.add(part, plane_[k].point, plane_[k].normal);
    if (heights.highest <= rounding_) return {};
    if (heights.lowest < -rounding_ && part.n < Polygon::capacity)
      part = clip(part, plane_[k].point, plane_[k].normal);
  }
  return part;
}

}  // namespace twopass
