// Quadrature over all directions that resolves lobes of any width: cells in the slope of the facet that leads
// from wo to wi, logarithmic in its length. Its own formulas, in double precision.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/core/types.h"

namespace twopass::test {

/// The unit vector at this angle to +z and this azimuth, radians.
inline V3f direction(float cos_theta, float phi) {
  const float s = std::sqrt(std::max(0.0f, 1.0f - cos_theta * cos_theta));
  return {s * std::cos(phi), s * std::sin(phi), cos_theta};
}

class FacetGrid {
 public:
  /// Slopes are measured in units of alpha. `eta` as in Case: with 0, directions below are those above,
  /// mirrored.
  FacetGrid(const V3f& wo, float alpha_u, float alpha_v, float eta)
      : wo_(wo.x, wo.y, wo.z),
        alpha_u_(alpha_u),
        alpha_v_(alpha_v),
        eta_(eta),
        log_min_(std::log(1e-3)),
        log_max_(std::log(1e3 / std::min(alpha_u, alpha_v))) {
    wo_ *= 1.0 / std::sqrt(wo_.dot(wo_));
  }

  static constexpr int radii = 24, angles = 12, cells = 2 * radii * angles;

  /// Calls visit(cell, wi, solid angle) for points all over the sphere.
  template <class Visit>
  void for_each_point(Visit visit) const {
    constexpr int finer_r = 16, finer_a = 10;
    const double dr = (log_max_ - log_min_) / (radii * finer_r), da = 2.0 * pi / (angles * finer_a);
    for (int i = 0; i < radii * finer_r; ++i)
      for (int j = 0; j < angles * finer_a; ++j) {
        const double r = std::exp(log_min_ + (i + 0.5) * dr), a = -pi + (j + 0.5) * da;
        const V3d slope(alpha_u_ * r * std::cos(a), alpha_v_ * r * std::sin(a), 1.0);
        const V3d m = slope * (1.0 / std::sqrt(slope.dot(slope)));
        const double facet_angle = alpha_u_ * alpha_v_ * r * r * dr * da * m.z * m.z * m.z;
        const int cell = i / finer_r * angles + j / finer_a;
        visit_reflection(m, facet_angle, cell, visit);
        if (eta_ > 0.0) visit_refraction(m, facet_angle, cell + radii * angles, visit);
      }
  }

  /// The cell that holds the direction.
  [[nodiscard]] int cell_of(const V3f& wi) const {
    const V3d w(wi.x, wi.y, wi.z);
    const bool below = wi.z < 0.0f;
    V3d m = !below ? wo_ + w : eta_ > 0.0 ? wo_ + w * eta_ : wo_ + V3d(w.x, w.y, -w.z);
    if (m.z < 0.0) m = -m;
    const double x = m.x / m.z / alpha_u_, y = m.y / m.z / alpha_v_;
    const double r = (0.5 * std::log(x * x + y * y) - log_min_) / (log_max_ - log_min_);
    const int i = std::clamp(static_cast<int>(r * radii), 0, radii - 1);
    const int j = std::clamp(static_cast<int>((std::atan2(y, x) + pi) / (2.0 * pi) * angles), 0, angles - 1);
    return i * angles + j + (below ? radii * angles : 0);
  }

 private:
  template <class Visit>
  void visit_reflection(const V3d& m, double facet_angle, int cell, Visit& visit) const {
    const double wo_m = wo_.dot(m);
    const V3d wi = m * (2.0 * wo_m) - wo_;
    if (wo_m <= 0.0 || wi.z <= 0.0) return;
    const double angle = facet_angle * 4.0 * wo_m;
    visit(cell, V3f(wi), angle);
    if (eta_ == 0.0) visit(cell + radii * angles, V3f(V3d(wi.x, wi.y, -wi.z)), angle);
  }
  template <class Visit>
  void visit_refraction(const V3d& m, double facet_angle, int cell, Visit& visit) const {
    const double wo_m = wo_.dot(m), cos2_t = 1.0 - (1.0 - wo_m * wo_m) / (eta_ * eta_);
    if (wo_m <= 0.0 || cos2_t <= 0.0) return;
    const double cos_t = std::sqrt(cos2_t);
    const V3d wi = m * (wo_m / eta_ - cos_t) - wo_ * (1.0 / eta_);
    const double path = wo_m - eta_ * cos_t;
    if (wi.z < 0.0) visit(cell, V3f(wi), facet_angle * path * path / (eta_ * eta_ * cos_t));
  }

  V3d wo_;
  double alpha_u_, alpha_v_, eta_, log_min_, log_max_;
};

}  // namespace twopass::test
