// Choosing one of n things with given probabilities.
#pragma once

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
  [[nodiscard]] Choice sample(float u) const;
  [[nodiscard]] float probability(std::uint32_t index) const { return probability_[index]; }
  [[nodiscard]] bool empty() const { return total_ == 0.0; }
  /// Sum of the weights.
  [[nodiscard]] double total() const { return total_; }

 private:
  std::vector<float> cumulative_;  // cumulative_[i] = probability of an index <= i; the last is 1
  std::vector<float> probability_;
  double total_ = 0.0;
};

}  // namespace twopass
