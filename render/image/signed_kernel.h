// A reconstruction kernel that is negative in places, tabulated so that positions can be drawn by its
// magnitude.
#pragma once

#include <functional>
#include <vector>

namespace twopass {

/// An even function k of the distance from the centre, of one dimension, zero beyond `radius`. Const once
/// built.
class SignedKernel {
 public:
  /// `value`: k on [0, radius]. REQUIRES: its integral is positive.
  SignedKernel(const std::function<double(double)>& value, double radius);

  /// Draws a position in [-radius, radius] with density pdf. REQUIRES: u in [0,1).
  [[nodiscard]] float sample(float u) const;
  /// |k| over its integral, as steps of 1/512 pixel; positive wherever k is not zero.
  [[nodiscard]] float pdf(float x) const;
  /// Of k, over [-radius, radius].
  [[nodiscard]] float integral() const { return integral_; }

 private:
  std::vector<float> cumulative_;  // share of |k| from the centre to the end of each step
  std::vector<float> density_;     // in each step
  float step_, radius_, integral_;
};

}  // namespace twopass
