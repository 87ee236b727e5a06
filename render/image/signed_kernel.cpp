#include "render/image/signed_kernel.h"

#include <algorithm>
#include <cmath>

namespace twopass {

SignedKernel::SignedKernel(const std::function<double(double)>& value, double radius) {
  constexpr double steps_a_pixel = 512.0;
  const auto count = static_cast<std::size_t>(std::ceil(radius * steps_a_pixel));
  const double step = radius / static_cast<double>(count);
  std::vector<double> shares, sums;
  double magnitude = 0.0, integral = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = static_cast<double>(i) * step;
    const double low = value(x), middle = value(x + 0.5 * step), high = value(x + step);
    const double share = (std::abs(low) + 4.0 * std::abs(middle) + std::abs(high)) / 6.0 * step;  // Simpson
    magnitude += share;
    integral += (low + 4.0 * middle + high) / 6.0 * step;
    shares.push_back(share);
    sums.push_back(magnitude);
  }
  for (const double sum : sums) cumulative_.push_back(static_cast<float>(sum / magnitude));
  cumulative_.back() = 1.0f;
  // Not from differences of the sums, which round to zero at the kernel's end.
  for (const double share : shares) density_.push_back(static_cast<float>(share / (2.0 * step * magnitude)));
  step_ = static_cast<float>(step);
  radius_ = static_cast<float>(radius);
  integral_ = static_cast<float>(2.0 * integral);
}

float SignedKernel::sample(float u) const {
  // As for the kernels without negative lobes: the sign of v gives the side, |v| the share from the centre on.
  const float v = 2.0f * u - 1.0f, share = std::abs(v);
  const auto end = std::ranges::upper_bound(cumulative_, share);
  const auto i = std::min(static_cast<std::size_t>(end - cumulative_.begin()), cumulative_.size() - 1);
  const float below = i > 0 ? cumulative_[i - 1] : 0.0f, width = cumulative_[i] - below;
  const float inside = width > 0.0f ? std::clamp((share - below) / width, 0.0f, 1.0f) : 0.0f;
  return std::copysign(std::min((static_cast<float>(i) + inside) * step_, radius_), v);
}

float SignedKernel::pdf(float x) const {
  const float r = std::abs(x);
  if (!(r <= radius_)) return 0.0f;
  const auto i = std::min(static_cast<std::size_t>(r / step_), density_.size() - 1);
  return density_[i];
}

}  // namespace twopass
