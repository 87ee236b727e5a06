#include "render/core/warp.h"

namespace twopass {

double spherical_triangle_solid_angle(const V3d& a, const V3d& b, const V3d& c) {
  const double numerator = std::abs(a.dot(b.cross(c)));
  const double denominator = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
  return 2.0 * std::atan2(numerator, denominator);
}

V3d square_to_spherical_triangle(double u, double v, const V3d& a, const V3d& b, const V3d& c) {
  const auto unit = [](const V3d& x) { return x / x.length(); };
  // The dihedral angle at a, and the sub-triangle (a, b, c') of u times the area, with c' on the arc from a to
  // c.
  const V3d normal_ab = unit(a.cross(b)), normal_ac = unit(a.cross(c));
  const double cos_alpha = std::clamp(normal_ab.dot(normal_ac), -1.0, 1.0);
  const double sin_alpha = std::sqrt(std::max(0.0, 1.0 - cos_alpha * cos_alpha));
  const double alpha = std::atan2(sin_alpha, cos_alpha);
  const double area = u * spherical_triangle_solid_angle(a, b, c);

  const double s = std::sin(area - alpha), t = std::cos(area - alpha);
  const double p = t - cos_alpha;
  const double q = s + sin_alpha * a.dot(b);
  const double numerator = (q * t - p * s) * cos_alpha - q;
  const double denominator = (q * s + p * t) * sin_alpha;
  const double cos_b = denominator == 0.0 ? 1.0 : std::clamp(numerator / denominator, -1.0, 1.0);
  const V3d toward_c = unit(c - a * a.dot(c));
  const V3d c_prime = a * cos_b + toward_c * std::sqrt(std::max(0.0, 1.0 - cos_b * cos_b));

  // A point on the arc from b to c', uniform in area.
  const double z = 1.0 - v * (1.0 - std::min(1.0, c_prime.dot(b)));
  const V3d across = c_prime - b * b.dot(c_prime);
  const double across_length = across.length();
  if (across_length == 0.0) return b;
  return b * z + across * (std::sqrt(std::max(0.0, 1.0 - z * z)) / across_length);
}

}  // namespace twopass
