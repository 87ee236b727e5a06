#include "render/core/distribution.h"

namespace twopass {

DiscreteDistribution::DiscreteDistribution(std::span<const double> weights) {
  for (const double weight : weights) total_ += weight;
  if (total_ == 0.0) return;
  double sum = 0.0;
  float before = 0.0f;
  for (const double weight : weights) {
    sum += weight;
    const float after = static_cast<float>(std::min(sum / total_, 1.0));
    cumulative_.push_back(after);
    // The probability is the width of the interval that sample() really uses, so that estimates stay unbiased.
    probability_.push_back(after - before);
    before = after;
  }
  // Rounding may leave the last interval short of 1: the last index of positive weight takes the rest.
  for (std::size_t i = cumulative_.size(); i-- > 0;) {
    if (weights[i] > 0.0) {
      probability_[i] += 1.0f - cumulative_[i];
      for (std::size_t k = i; k < cumulative_.size(); ++k) cumulative_[k] = 1.0f;
      break;
    }
  }
  for (const float probability : probability_)
    reciprocal_.push_back(probability > 0.0f ? 1.0f / probability : 0.0f);
}

}  // namespace twopass
