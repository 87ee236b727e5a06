// Means of what an integrator sees over a bundle of rays.
#pragma once

#include "integrators/make_integrator.h"
#include "tests/support/statistics.h"

namespace twopass::test {

/// The mean over the channels of the radiance of `samples` rays from `origin` in uniform directions of the cone
/// around `axis` of the given half angle. Independent random numbers, so that the standard error is honest.
inline Estimate mean_radiance(const Integrator& integrator, const V3f& origin, const V3f& axis,
                              float cos_half_angle, int samples, std::uint32_t seed) {
  Estimate estimate;
  const Frame frame(axis.normalized());
  RayCounts counts;
  for (int i = 0; i < samples; ++i) {
    Sampler sampler(seed, static_cast<std::uint32_t>(i), 0);
    const V2f u = sampler.next_2d();
    const float z = 1.0f - u.x * (1.0f - cos_half_angle), r = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const V3f w = frame.to_world({r * std::cos(2 * pi_f * u.y), r * std::sin(2 * pi_f * u.y), z});
    estimate.add(mean_component(integrator.radiance({origin, w}, sampler, counts).radiance));
  }
  return estimate;
}

/// The difference of two independent estimates in units of its standard error.
inline double z_score(const Estimate& a, const Estimate& b) {
  const double error = std::hypot(a.standard_error(), b.standard_error());
  const double difference = a.mean() - b.mean();
  return error > 0.0 ? difference / error : (difference == 0.0 ? 0.0 : INFINITY);
}

}  // namespace twopass::test
