// How much of light from one direction a surface reflects diffusely, against light that comes evenly from all.
#pragma once

#include <array>

#include "materials/material.h"

namespace twopass {

/// A radiosity solution knows how much light arrives, not from where: it takes reflectances of light that comes
/// evenly from all around. Coats let more of steep light through than of grazing light. Factors by which
/// irradiance from known directions count for more or less (M32).
class DiffuseResponse {
 public:
  /// For each of 4 choices of a mixture, at the origin of the side's textures.
  explicit DiffuseResponse(const MaterialSide& side);

  /// 1 whatever the direction: Lambert's model, and sides that do not reflect diffusely.
  [[nodiscard]] bool is_even() const { return is_even_; }
  /// The factor, >= 0, of light whose direction has this cosine, in [0, 1], with the normal: 1 on average over
  /// evenly distributed light. Linear between 33 cosines.
  [[nodiscard]] double at(double cosine) const {
    const double place = std::clamp(cosine, 0.0, 1.0) * steps;
    const auto k = std::min(static_cast<std::size_t>(place), steps - 1);
    return at_[k] + (at_[k + 1] - at_[k]) * (place - static_cast<double>(k));
  }

 private:
  static constexpr std::size_t steps = 32;
  bool is_even_ = true;
  std::array<double, steps + 1> at_;
};

}  // namespace twopass
