#include "radiosity/form_factor_pair.h"

#include <utility>

#include "radiosity/contour.h"
#include "radiosity/lambert.h"
#include "radiosity/polygon_cubature.h"

namespace twopass {
namespace {

// A polygon clipped to what the other one can see, with what every rung of the ladder asks of it.
struct Side {
  Polygon polygon;
  V3d normal;  // unit
  double area;
  V3d centroid;
  double radius;
};

// Any strict order will do; this one makes the result independent of the arguments' order to the last bit.
bool comes_before(const Polygon& a, const Polygon& b) {
  if (a.n != b.n) return a.n < b.n;
  for (int i = 0; i < a.n; ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (a.v[i][axis] != b.v[i][axis]) return a.v[i][axis] < b.v[i][axis];
  return false;
}

Polygon relative_to(const V3d& origin, const Polygon& polygon) {
  Polygon moved = polygon;
  for (int i = 0; i < polygon.n; ++i) moved.v[i] -= origin;
  return moved;
}

// Where a polygon lies relative to a plane through `point`: its lowest and its highest vertex.
struct Heights {
  double lowest, highest;
  double reach2;  // the largest squared distance of a vertex from the point

  // Rounding can only matter to polygons this flat; the full test costs as much as a far pair.
  bool nearly_in_plane() const { return highest * highest <= 1e-12 * reach2; }
};

Heights heights_above(const V3d& point, const V3d& unit_normal, const Polygon& polygon) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Heights heights{infinity, -infinity, 0.0};
  for (int i = 0; i < polygon.n; ++i) {
    const V3d w = polygon.v[i] - point;
    const double h = unit_normal.dot(w);
    heights.lowest = std::min(heights.lowest, h);
    heights.highest = std::max(heights.highest, h);
    heights.reach2 = std::max(heights.reach2, w.length2());
  }
  return heights;
}

Side make_side(const Polygon& polygon, const V3d& unit_normal, double area) {
  const V3d centroid = polygon_centroid(polygon);
  return {polygon, unit_normal, area, centroid, polygon_radius(polygon, centroid)};
}

double distance_to_boundary(const V3d& point, const Polygon& polygon) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < polygon.n; ++i) {
    const V3d e = polygon.next(i) - polygon.v[i], w = point - polygon.v[i];
    const double length2 = e.length2();
    const double t = length2 > 0.0 ? std::clamp(w.dot(e) / length2, 0.0, 1.0) : 0.0;
    least = std::min(least, (w - e * t).length2());
  }
  return std::sqrt(least);
}

constexpr int out_of_reach = Cubature::max_order + 1;

// (R10): the order of Gauss's rule on `side` for an integrand whose nearest singularity is `distance` from the
// centre. A side that reaches down to the other's plane has an integrand that varies as much as it is large:
// `slope`.
int order_for(const Side& side, const Side& other, double distance, double relative_accuracy) {
  const double k = distance / side.radius;
  if (!(k > 1.2)) return out_of_reach;
  const double rho = k + std::sqrt(k * k - 1.0), gain = rho * rho;
  const double height = other.normal.dot(side.centroid - other.centroid);
  const double slope = side.radius < 3.0 * height ? side.radius / height : 3.0;
  const double goal = 6.0 * (1.0 + slope * rho) / relative_accuracy;
  int order = 1;
  for (double reached = gain; reached < goal && order < out_of_reach; ++order) reached *= gain;
  return order;
}

Cubature cubature_of(const Side& side, int order) {
  Cubature cubature;
  if (order > 1) {
    make_cubature(side.polygon, side.normal, order, cubature);
  } else {
    cubature.points[0] = {side.centroid, side.area};
    cubature.n = 1;
  }
  return cubature;
}

// (R1) summed over pairs of points.
double point_pairs(const Side& a, const Side& b, int order_a, int order_b) {
  const Cubature on_a = cubature_of(a, order_a), on_b = cubature_of(b, order_b);
  double sum = 0.0;
  for (int i = 0; i < on_a.n; ++i) {
    double irradiance = 0.0;
    for (int j = 0; j < on_b.n; ++j) {
      const V3d w = on_b.points[j].p - on_a.points[i].p;
      const double r2 = w.length2();
      irradiance -= on_b.points[j].area * a.normal.dot(w) * b.normal.dot(w) / (r2 * r2);
    }
    sum += on_a.points[i].area * irradiance;
  }
  return std::max(0.0, sum / pi);
}

// (R2) integrated over the receiving polygon.
double lambert_at_points(const Side& receiver, const Side& source, int order) {
  const Cubature cubature = cubature_of(receiver, order);
  double sum = 0.0;
  for (int i = 0; i < cubature.n; ++i)
    sum += cubature.points[i].area *
           signed_point_form_factor(cubature.points[i].p, receiver.normal, source.polygon);
  return std::max(0.0, sum);
}

// Costs in units of one pair of points, measured.
constexpr int lambert_cost = 35;
constexpr int contour_cost = 1500;

int points_of(const Side& side, int order) {
  return order == 1 ? 1 : order * order * (side.polygon.n == 3 ? 1 : side.polygon.n - 2);
}

double exchange_of_sides(const Side& a, const Side& b, double relative_accuracy) {
  const double apart = (b.centroid - a.centroid).length();
  const int order_a = order_for(a, b, apart - b.radius, relative_accuracy);
  const int order_b = order_for(b, a, apart - a.radius, relative_accuracy);
  const bool pairs_possible = std::max(order_a, order_b) < out_of_reach;
  const int pairs_cost = points_of(a, order_a) * points_of(b, order_b);
  if (pairs_possible && pairs_cost <= lambert_cost) return point_pairs(a, b, order_a, order_b);

  const Side& small = a.radius < b.radius ? a : b;
  const Side& large = a.radius < b.radius ? b : a;
  const double to_singularity = distance_to_boundary(small.centroid, large.polygon);
  const int order = order_for(small, large, to_singularity, relative_accuracy);
  const int single_cost = lambert_cost * points_of(small, order);
  if (pairs_possible && pairs_cost <= std::min(single_cost, contour_cost))
    return point_pairs(a, b, order_a, order_b);
  if (order < out_of_reach && single_cost <= contour_cost) return lambert_at_points(small, large, order);
  return contour_exchange_clipped(a.polygon, b.polygon, relative_accuracy);
}

}  // namespace

double exchange_exact(const Polygon& first, const Polygon& second, double relative_accuracy) {
  if (first.empty() || second.empty()) return 0.0;
  const bool swap = comes_before(second, first);
  const V3d origin = (swap ? second : first).v[0];
  Polygon a = relative_to(origin, swap ? second : first), b = relative_to(origin, swap ? first : second);
  const V3d vector_a = polygon_area_vector(a), vector_b = polygon_area_vector(b);
  double area_a = vector_a.length(), area_b = vector_b.length();
  if (!(area_a > 0.0) || !(area_b > 0.0)) return 0.0;
  const V3d normal_a = vector_a / area_a, normal_b = vector_b / area_b;

  const V3d point_a = a.v[0], point_b = b.v[0];
  const Heights heights_a = heights_above(point_b, normal_b, a),
                heights_b = heights_above(point_a, normal_a, b);
  if (!(heights_a.highest > 0.0) || !(heights_b.highest > 0.0)) return 0.0;
  if (heights_a.nearly_in_plane() && heights_b.nearly_in_plane() && are_coplanar(first, second)) return 0.0;
  if (heights_a.lowest < 0.0) {
    a = clip(a, point_b, normal_b);
    area_a = polygon_area(a);
  }
  if (heights_b.lowest < 0.0) {
    b = clip(b, point_a, normal_a);
    area_b = polygon_area(b);
  }
  if (!(area_a > 0.0) || !(area_b > 0.0)) return 0.0;
  return exchange_of_sides(make_side(a, normal_a, area_a), make_side(b, normal_b, area_b), relative_accuracy);
}

double exchange_point(const Polygon& receiver, const Polygon& source) {
  if (receiver.empty() || source.empty()) return 0.0;
  const V3d area_vector = polygon_area_vector(receiver);
  const double area = area_vector.length();
  if (!(area > 0.0)) return 0.0;
  return area * point_form_factor(polygon_centroid(receiver), area_vector / area, source);
}

}  // namespace twopass
