#include "radiosity/contour.h"

#include <cassert>

#include "radiosity/gauss_rules.h"
#include "radiosity/lambert.h"

namespace twopass {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

struct Edge {
  V3d start;
  V3d direction;  // unit
  double length;

  V3d at(double s) const { return start + direction * s; }
};

Edge part_of(const Edge& edge, double from, double to) { return {edge.at(from), edge.direction, to - from}; }

// x ln x and the like at x = 0.
double times_log(double factor, double squared_distance) {
  return squared_distance > 0.0 ? factor * std::log(squared_distance) : 0.0;
}

// (R4): the first and the second antiderivative of ln sqrt(u^2 + h^2) in u.
double log_antiderivative(double u, double h) {
  return 0.5 * times_log(u, u * u + h * h) - u + h * std::atan2(u, h);
}
double log_second_antiderivative(double u, double h) {
  return 0.25 * times_log(u * u - h * h, u * u + h * h) - 0.75 * u * u + h * u * std::atan2(u, h);
}

// (R9): Int ln |point - y| over y on the edge: the difference of two (R4), arranged so that a point far away
// costs no digits.
double log_potential(const V3d& point, const Edge& edge) {
  const V3d w = point - edge.start;
  const double foot = w.dot(edge.direction);
  const double h2 = w.cross(edge.direction).length2(), h = std::sqrt(h2);
  const double u0 = -foot, u1 = edge.length - foot;
  const double r0 = u0 * u0 + h2, r1 = u1 * u1 + h2;
  if (!(r0 > 0.0) || !(r1 > 0.0)) return log_antiderivative(u1, h) - log_antiderivative(u0, h);
  const double middle = 0.5 * (u0 + u1), log_r0 = std::log(r0);
  const double change = 2.0 * edge.length * middle / r0;  // r1 / r0 - 1
  const double log_ratio = std::abs(change) < 0.5 ? std::log1p(change) : std::log(r1) - log_r0;
  return 0.5 * (edge.length * (log_r0 + 0.5 * log_ratio) + middle * log_ratio) - edge.length +
         h * std::atan2(h * edge.length, h2 + u0 * u1);
}

// (R5): parallel edges, overlapping or touching ones included. b, the longer one, knows the direction better.
double parallel_integral(const Edge& a, const Edge& b) {
  const V3d offset = a.start - b.start;
  const double w = offset.dot(b.direction);
  const double h = offset.cross(b.direction).length();
  const auto g = [h](double u) { return log_second_antiderivative(u, h); };
  if (a.direction.dot(b.direction) > 0.0)
    return g(w - b.length) + g(w + a.length) - g(w + a.length - b.length) - g(w);
  return g(w - a.length - b.length) + g(w) - g(w - b.length) - g(w - a.length);
}

// (R6): both edges start at one point; lengths a and b along their directions, either may be negative.
double corner_integral(double a, double b, double cosine, double sine) {
  const double sign = (a < 0.0) != (b < 0.0) ? -1.0 : 1.0;
  a = std::abs(a);
  b = std::abs(b);
  // Nothing, and the quotients below would overflow.
  if (std::min(a, b) <= 1e-100 * std::max(a, b)) return 0.0;
  const double c = sign * cosine;
  const auto k = [c, sine](double x) { return log_antiderivative(x - c, sine) - log_antiderivative(-c, sine); };
  return sign * 0.5 * (a * b * (std::log(a) + std::log(b) - 1.0) + a * a * k(b / a) + b * b * k(a / b));
}

// How two straight lines pass each other, with arguments along the edges.
struct Passing {
  bool parallel;  // as far as the rounding of the coordinates can tell; nothing below is set then
  double cosine, sine;
  double s, t;       // where the lines are nearest: on a's line, on b's line
  double gap;        // the distance there
  double complex_s;  // the imaginary part of the argument on a at which the distance from b's line vanishes
  double margin_t;   // ... and how far from t on b's line that zero may lie
};

// REQUIRES: a is not longer than b. `rounding` is the distance that coordinates cannot tell from 0.
Passing pass(const Edge& a, const Edge& b, double rounding) {
  Passing p{};
  const V3d normal = a.direction.cross(b.direction);
  p.cosine = a.direction.dot(b.direction);
  p.sine = normal.length();
  p.parallel = p.sine * a.length <= rounding;
  if (p.parallel) return p;
  p.s = (b.start - a.start).cross(b.direction).dot(normal) / (p.sine * p.sine);
  // Between nearly parallel lines s is uncertain; t belongs to this s, and the gap tells whether they do meet
  // there.
  const V3d w = a.at(p.s) - b.start;
  p.t = w.dot(b.direction);
  p.gap = (w - b.direction * p.t).length();
  p.complex_s = p.gap / p.sine;
  p.margin_t = std::abs(p.cosine) * p.complex_s;
  return p;
}

// (R8): how smooth log_potential(., b) is along a from s0 to s1: the half sum of the axes, (rho + 1/rho) / 2,
// of the largest ellipse with foci s0 and s1 that holds none of the function's singularities.
double smoothness(const Edge& a, const Edge& b, const Passing& passing, double s0, double s1) {
  const V3d p0 = a.at(s0), p1 = a.at(s1), q1 = b.at(b.length);
  double sum =
      std::min((p0 - b.start).length() + (p1 - b.start).length(), (p0 - q1).length() + (p1 - q1).length());
  if (!passing.parallel && passing.t > -passing.margin_t && passing.t < b.length + passing.margin_t)
    sum = std::min(
        sum, std::hypot(s0 - passing.s, passing.complex_s) + std::hypot(s1 - passing.s, passing.complex_s));
  return sum / (s1 - s0);
}

// Below this a piece of an edge is cut in two; above it 13 points give all digits.
constexpr double smooth_enough = 1.8;
constexpr int deepest_cut = 60;

// The pair of edges and what all pieces of it share.
struct EdgePair {
  const Edge& a;
  const Edge& b;
  Passing passing;
  double accuracy;
};

// (R7): log_potential integrated over a piece of a by Gauss's rule, as many points as the smoothness asks for.
double smooth_integral(const EdgePair& pair, double s0, double s1, double ellipse) {
  const double rho = ellipse + std::sqrt(ellipse * ellipse - 1.0);
  const double wanted = std::ceil(0.5 * std::log(1.0 / pair.accuracy) / std::log(rho));
  const GaussRule& rule =
      gauss_legendre(static_cast<int>(std::clamp(wanted, 1.0, double(GaussRule::max_points))));
  double sum = 0.0;
  for (int i = 0; i < rule.n; ++i)
    sum += rule.w[i] * log_potential(pair.a.at(s0 + (s1 - s0) * rule.x[i]), pair.b);
  return sum * (s1 - s0);
}

double graded_integral(const EdgePair& pair, double s0, double s1, int depth) {
  const double ellipse = smoothness(pair.a, pair.b, pair.passing, s0, s1);
  if (ellipse >= smooth_enough) return smooth_integral(pair, s0, s1, ellipse);
  const double middle = 0.5 * (s0 + s1);
  // Only rounding gets this deep; the piece is 2^-60 of the edge and the integrand is bounded by a logarithm.
  if (depth == deepest_cut) return (s1 - s0) * log_potential(pair.a.at(middle), pair.b);
  return graded_integral(pair, s0, middle, depth + 1) + graded_integral(pair, middle, s1, depth + 1);
}

// Two edges, the one not much longer than the other: closed forms if they are parallel or cross, whatever they
// touch.
double near_integral(const EdgePair& pair, double rounding) {
  const auto& [a, b, passing, accuracy] = pair;
  if (passing.parallel) return parallel_integral(a, b);
  const double reach = 8.0 * b.length;  // a crossing farther away would cost the closed form its digits
  if (passing.gap > rounding || std::abs(passing.s) > reach || std::abs(passing.t) > reach)
    return graded_integral(pair, 0.0, a.length, 0);
  const double s0 = -passing.s, s1 = a.length - passing.s, t0 = -passing.t, t1 = b.length - passing.t;
  const auto corner = [&p = pair.passing](double s, double t) {
    return corner_integral(s, t, p.cosine, p.sine);
  };
  return corner(s1, t1) - corner(s0, t1) - corner(s1, t0) + corner(s0, t0);
}

// Int Int ln r ds dt over two edges. `rounding` is the distance that coordinates cannot tell from 0.
double edge_integral(const Edge& first, const Edge& second, double rounding, double accuracy) {
  const bool swap = first.length > second.length;
  const Edge &a = swap ? second : first, &b = swap ? first : second;
  if (a.length <= rounding) return a.length * log_potential(a.at(0.5 * a.length), b);
  const EdgePair pair{a, b, pass(a, b, rounding), accuracy};
  const double ellipse = smoothness(a, b, pair.passing, 0.0, a.length);
  if (ellipse >= smooth_enough) return smooth_integral(pair, 0.0, a.length, ellipse);
  if (b.length <= 6.0 * a.length) return near_integral(pair, rounding);

  // Only the part of b near a needs a closed form, and the form keeps its digits only between edges of one
  // size.
  const double foot = (a.at(0.5 * a.length) - b.start).dot(b.direction);
  const double from = std::clamp(foot - 2.5 * a.length, 0.0, b.length);
  const double to = std::clamp(foot + 2.5 * a.length, 0.0, b.length);
  const auto pair_with = [&](const Edge& part) { return EdgePair{a, part, pass(a, part, rounding), accuracy}; };
  const Edge before = part_of(b, 0.0, from), beside = part_of(b, from, to), after = part_of(b, to, b.length);
  double sum = 0.0;
  if (before.length > 0.0) sum += graded_integral(pair_with(before), 0.0, a.length, 0);
  if (beside.length > 0.0) sum += near_integral(pair_with(beside), rounding);
  if (after.length > 0.0) sum += graded_integral(pair_with(after), 0.0, a.length, 0);
  return sum;
}

struct Outline {
  std::array<Edge, Polygon::capacity> edge;
  int n = 0;
};

Outline outline_of(const Polygon& polygon, const V3d& origin, double scale) {
  Outline outline;
  for (int i = 0; i < polygon.n; ++i) {
    const V3d e = (polygon.next(i) - polygon.v[i]) * scale;
    const double length = e.length();
    if (length > 0.0) outline.edge[outline.n++] = {(polygon.v[i] - origin) * scale, e / length, length};
  }
  return outline;
}

// The size of the terms of (R3), whose integrands are logarithms of order one.
double magnitude(const Outline& a, const Outline& b) {
  double sum = 0.0;
  for (int i = 0; i < a.n; ++i)
    for (int j = 0; j < b.n; ++j)
      sum += std::abs(a.edge[i].direction.dot(b.edge[j].direction)) * a.edge[i].length * b.edge[j].length;
  return sum;
}

// (R3), the double sum over the edges.
double contour_sum(const Outline& a, const Outline& b, double rounding, double accuracy) {
  double sum = 0.0;
  for (int i = 0; i < a.n; ++i)
    for (int j = 0; j < b.n; ++j) {
      const double cosine = a.edge[i].direction.dot(b.edge[j].direction);
      if (cosine != 0.0) sum += cosine * edge_integral(a.edge[i], b.edge[j], rounding, accuracy);
    }
  return sum;
}

// The exchange as the centroid of the smaller polygon sees it: right to a small factor wherever the polygons
// are.
double one_point_estimate(const Polygon& a, const Polygon& b) {
  const V3d vector_a = polygon_area_vector(a), vector_b = polygon_area_vector(b);
  const double area_a = vector_a.length(), area_b = vector_b.length();
  if (!(area_a > 0.0) || !(area_b > 0.0)) return 0.0;
  return area_a < area_b ? area_a * signed_point_form_factor(polygon_centroid(a), vector_a / area_a, b)
                         : area_b * signed_point_form_factor(polygon_centroid(b), vector_b / area_b, a);
}

}  // namespace

double contour_exchange_clipped(const Polygon& a, const Polygon& b, double relative_accuracy) {
  if (a.empty() || b.empty()) return 0.0;
  const V3d origin = a.v[0];
  double farthest = 0.0;
  for (int i = 0; i < b.n; ++i) farthest = std::max(farthest, (b.v[i] - origin).length());
  if (!(farthest > std::numeric_limits<double>::min())) return 0.0;
  // A power of two near the distance: scaling is exact, and the logarithms come out small, so little of them
  // cancels.
  const int exponent = std::ilogb(farthest);
  const double scale = std::ldexp(1.0, -exponent);
  const double rounding = 16.0 * epsilon * std::max(largest_coordinate(a), largest_coordinate(b)) * scale;
  const Outline outline_a = outline_of(a, origin, scale), outline_b = outline_of(b, origin, scale);
  const double terms = magnitude(outline_a, outline_b);
  if (!(terms > 0.0)) return 0.0;
  // The terms cancel more the farther apart the polygons are: what will be left says how exact they must be.
  const double accuracy = relative_accuracy * one_point_estimate(a, b) * scale * scale / terms;
  const double sum = contour_sum(outline_a, outline_b, rounding, std::clamp(accuracy, 1e-14, 1e-2));
  assert(std::isfinite(sum));
  return std::max(0.0, sum / (2.0 * pi * scale * scale));
}

double contour_exchange(const Polygon& a, const Polygon& b, double relative_accuracy) {
  if (a.empty() || b.empty() || are_coplanar(a, b)) return 0.0;
  const V3d normal_a = polygon_area_vector(a), normal_b = polygon_area_vector(b);
  return contour_exchange_clipped(clip(a, b.v[0], normal_b), clip(b, a.v[0], normal_a), relative_accuracy);
}

}  // namespace twopass
