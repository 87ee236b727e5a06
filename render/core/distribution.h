// Choosing one of n things with given probabilities.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace twopass {

/// A discrete distribution sampled by inversion: monotone in u, so stratified numbers stay stratified.
class DiscreteDistribution {
 public:
  DiscreteDistribution() = default;
  /// REQUIRES: weights finite and >= 0. All zero is allowed: then `empty()` holds and nothing can be sampled.
  explicit DiscreteDistribution(std::span<const double> weights);

  struct Choice {
    std::uint32_t index;
    float probability;
    float remapped;  ///< u stretched back to [0, 1) within the choice, to be used again
  };
  /// REQUIRES: !empty(), u in [0, 1).
  [[nodiscard]] Choice sample(float u) const {
    const std::uint32_t index = find(u);
    const float begin = index == 0 ? 0.0f : cumulative_[index - 1];
    const float remapped = (u - begin) * reciprocal_[index];
    return {index, probability_[index], std::min(remapped, 0x1.fffffep-1f)};
  }
  [[nodiscard]] float probability(std::uint32_t index) const { return probability_[index]; }
  [[nodiscard]] bool empty() const { return total_ == 0.0; }
  /// Sum of the weights.
  [[nodiscard]] double total() const { return total_; }

 private:
  // The first index whose cumulative probability exceeds u, by bisection without branches: random numbers would
  // have them mispredicted half of the time.
  [[nodiscard]] std::uint32_t find(float u) const {
    std::uint32_t first = 0;
    for (auto count = static_cast<std::uint32_t>(cumulative_.size()); count > 1;) {
      const std::uint32_t half = count / 2;
      first += cumulative_[first + half - 1] <= u ? half : 0;
      count -= half;
    }
    return first;
  }

  std::vector<float> cumulative_;  // cumulative_[i] = probability of an index <= i; the last is 1
  std::vector<float> probability_;
  std::vector<float> reciprocal_;  // 1 / probability
  double total_ = 0.0;
};

}  // namespace twopass
