#include "render/scene/projected_polygon.h"

namespace twopass {

namespace {

// x in [0, 1] with a density that is linear from `a` to `b`.
double linear(double u, double a, double b) {
  const double root = std::sqrt((1.0 - u) * a * a + u * b * b);
  return a + root > 0.0 ? std::min(1.0, u * (a + b) / (a + root)) : u;
}

// The angle in [0, pi] of the point (x, y), y >= 0, to a few units in the last place: half of the time went
// into the library's. From a multiple of 1/8 of the tangent, the series is short.
double angle_of(double y, double x) {
  static const std::array<double, 9> steps = [] {
    std::array<double, 9> angles;
    for (int k = 0; k <= 8; ++k) angles[k] = std::atan(k / 8.0);
    return angles;
  }();
  const double width = std::abs(x);
  const bool is_steep = y > width;
  const double a = is_steep ? width : y, b = is_steep ? y : width;
  if (!(b > 0.0)) return 0.0;
  const int k = static_cast<int>(8.0 * a / b + 0.5);
  const double step = k * 0.125, z = (a - b * step) / (b + a * step), z2 = z * z;
  // At |z| <= 1/16 the first omitted term is 6e-20.
  const double series =
      1.0 +
      z2 * (-1.0 / 3 + z2 * (1.0 / 5 + z2 * (-1.0 / 7 + z2 * (1.0 / 9 + z2 * (-1.0 / 11 + z2 * (1.0 / 13))))));
  double angle = steps[static_cast<std::size_t>(k)] + z * series;
  if (is_steep) angle = 0.5 * pi - angle;
  return x < 0.0 ? pi - angle : angle;
}

// One edge of the outline between two azimuths c0 and c1 (unit vectors of the plane): above the azimuth c0 + t
// (c1 - c0) it has the direction w(t), linear in t.
class Arc {
 public:
  Arc(const V3d& normal, const V2d& c0, const V2d& c1) : height_(std::abs(normal.z)) {
    const double sign = normal.z > 0.0 ? -1.0 : 1.0;
    z0_ = sign * (normal.x * c0.x + normal.y * c0.y);
    z1_ = sign * (normal.x * c1.x + normal.y * c1.y);
    // In the basis of w(0) and the tangent there, w(t) = (p0 + t (p1 - p0), t q).
    const V3d w0(height_ * c0.x, height_ * c0.y, z0_), w1(height_ * c1.x, height_ * c1.y, z1_);
    p0_ = w0.dot(w0);
    p1_ = w0.dot(w1);
    q_ = w0.cross(w1).length();
  }
  struct Part {
    double area, slope, curvature;  // of the sector from t = 0: its value and derivatives
  };
  // The area between the origin and the arc, from its begin to t.
  [[nodiscard]] Part part(double t) const {
    const double p = p0_ + t * (p1_ - p0_), y = t * q_, l2 = p * p + y * y;
    if (!(l2 > 0.0)) return {0.0, 0.0, 0.0};
    const double slope = 0.5 * height_ * q_ * p0_ / l2;
    return {0.5 * height_ * angle_of(y, p), slope, -2.0 * slope * (p * (p1_ - p0_) + y * q_) / l2};
  }
  // The squared height above the plane of the arc's point at t; `c2` is the squared length of its azimuth.
  [[nodiscard]] double z2(double t, double c2) const {
    const double z = z0_ + t * (z1_ - z0_), z2 = z * z, l2 = height_ * height_ * c2 + z2;
    return l2 > 0.0 ? z2 / l2 : 1.0;
  }

 private:
  double height_, z0_, z1_, p0_, p1_, q_;
};

double cross(const V2d& a, const V2d& b) { return a.x * b.y - a.y * b.x; }

}  // namespace

ProjectedPolygon::ProjectedPolygon(std::span<const V3d> corners) {
  const int count = static_cast<int>(corners.size());
  for (int i = 0; i < count; ++i) {
    const V3d &a = corners[i], &b = corners[i + 1 == count ? 0 : i + 1];
    if (a.z >= 0.0) corner_[n_++] = a;
    // Neither end is cut off by rounding: signs differ strictly. A convex outline crosses the plane twice at
    // most.
    if (a.z * b.z < 0.0 && n_ < capacity) {
      V3d cut = a + (b - a) * (a.z / (a.z - b.z));
      cut.z = 0.0;
      corner_[n_++] = cut;
    }
    if (n_ == capacity) break;
  }
  if (n_ < 3) return;
  for (int i = 0; i < n_; ++i) {
    const double length = corner_[i].length();
    if (!(length > 0.0)) return;
    corner_[i] /= length;
  }
  holds_zenith_ = true;
  double sum = 0.0;
  for (int i = 0; i < n_; ++i) {
    const V3d outward = corner_[i].cross(corner_[next(i)]);
    const double sine = outward.length();
    normal_[i] = sine > 0.0 ? outward / sine : V3d(0.0);
    length_[i] = angle_of(sine, corner_[i].dot(corner_[next(i)]));
    part_[i] = 0.5 * normal_[i].z * length_[i];
    sum += part_[i];
    // A zenith on the outline counts as inside, where nothing degenerates.
    constexpr double rounding = 1e-12;
    if (normal_[i].z < -rounding) holds_zenith_ = false;
  }
  area_ = std::max(0.0, sum);
}

V3d ProjectedPolygon::sample(const V2f& u) const {
  return holds_zenith_ ? sample_around_zenith(u.x, u.y) : sample_beside_zenith(u.x, u.y);
}

// Sectors from the zenith to one edge each: equal arc lengths of the edge have equal areas.
V3d ProjectedPolygon::sample_around_zenith(double u, double v) const {
  double left = u * area_;
  int i = 0;
  while (i + 1 < n_ && left >= part_[i]) left -= std::max(0.0, part_[i++]);
  const double angle = part_[i] > 0.0 ? std::min(1.0, left / part_[i]) * length_[i] : 0.0;
  const V3d rim = corner_[i] * std::cos(angle) + normal_[i].cross(corner_[i]) * std::sin(angle);
  const double r = std::sqrt(v);
  return {rim.x * r, rim.y * r, std::sqrt(std::max(0.0, 1.0 - v * (rim.x * rim.x + rim.y * rim.y)))};
}

// Sectors between the azimuths of neighbouring corners, each between an outer and an inner edge.
V3d ProjectedPolygon::sample_beside_zenith(double u, double v) const {
  std::array<V2d, capacity> azimuth;
  int first = 0, last = 0;
  for (int i = 0; i < n_; ++i) {
    const V2d c(corner_[i].x, corner_[i].y);
    const double length = c.length();
    azimuth[i] = length > 0.0 ? c / length : V2d(1.0, 0.0);
    if (cross(azimuth[i], azimuth[first]) > 0.0) first = i;
    if (cross(azimuth[last], azimuth[i]) > 0.0) last = i;
  }
  struct Sector {
    int outer, inner;  // edges
    V2d begin, end;
    double area;
  };
  std::array<Sector, 2 * capacity> sectors;
  int count = 0;
  double total = 0.0;
  // The outer edges run along with the azimuth, the inner ones against it.
  int outer = first, inner = first == 0 ? n_ - 1 : first - 1;
  for (V2d at = azimuth[first]; count < n_ && (outer != last || next(inner) != last);) {
    const bool outer_is_left = outer != last, inner_is_left = next(inner) != last;
    const bool outer_ends_first =
        outer_is_left && (!inner_is_left || cross(azimuth[next(outer)], azimuth[inner]) >= 0.0);
    const V2d to = outer_ends_first ? azimuth[next(outer)] : azimuth[inner];
    Sector& s = sectors[count++];
    s = {outer_is_left ? outer : (outer == 0 ? n_ - 1 : outer - 1), inner_is_left ? inner : next(inner), at, to,
         0.0};
    s.area = std::max(
        0.0, Arc(normal_[s.outer], at, to).part(1.0).area - Arc(normal_[s.inner], at, to).part(1.0).area);
    total += s.area;
    at = to;
    if (outer_ends_first)
      outer = next(outer);
    else
      inner = inner == 0 ? n_ - 1 : inner - 1;
  }
  if (!(total > 0.0)) return corner_[0];
  double wanted = u * total;
  int k = 0;
  while (k + 1 < count && wanted >= sectors[k].area) wanted -= sectors[k++].area;
  const Sector& s = sectors[k];
  const Arc far_arc(normal_[s.outer], s.begin, s.end), near_arc(normal_[s.inner], s.begin, s.end);

  // Halley's iteration for the azimuth, kept inside of a shrinking bracket; it starts as if the width were
  // linear.
  const auto width = [&](double at) {
    const Arc::Part a = far_arc.part(at), b = near_arc.part(at);
    return Arc::Part{a.area - b.area, a.slope - b.slope, a.curvature - b.curvature};
  };
  wanted = std::min(wanted, s.area);
  const double fraction = s.area > 0.0 ? wanted / s.area : 0.5;
  double lo = 0.0, hi = 1.0, t = 0.5;
  t = linear(fraction, std::max(0.0, width(0.0).slope), std::max(0.0, width(1.0).slope));
  constexpr int most_steps = 30;
  constexpr double tolerance = 1e-7;
  for (int step = 0; step < most_steps; ++step) {
    const Arc::Part f = width(t);
    const double excess = f.area - wanted;
    if (std::abs(excess) <= tolerance * s.area) break;
    (excess > 0.0 ? hi : lo) = t;
    const double newton = f.slope - 0.5 * excess * f.curvature / f.slope;
    t -= excess / newton;
    if (!(t > lo && t < hi)) t = 0.5 * (lo + hi);
  }
  const V2d c = s.begin + (s.end - s.begin) * t;
  const double c2 = c.dot(c), far_z2 = far_arc.z2(t, c2), near_z2 = near_arc.z2(t, c2);
  const double z2 = near_z2 + v * (far_z2 - near_z2);
  const double r = std::sqrt(std::max(0.0, 1.0 - z2) / c2);
  return {c.x * r, c.y * r, std::sqrt(z2)};
}

}  // namespace twopass
