#include "render/core/distribution.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/statistics.h"

namespace twopass {
namespace {

TEST(DiscreteDistribution, ProbabilitiesAreTheWeightsAndTheFrequencies) {
  const std::vector<double> weights{1.0, 0.0, 3.0, 1e-3, 5.0, 0.0};
  const DiscreteDistribution d(weights);
  double sum = 0.0;
  for (std::uint32_t i = 0; i < weights.size(); ++i) {
    EXPECT_NEAR(d.probability(i), weights[i] / 9.001, 1e-6);
    sum += d.probability(i);
  }
  EXPECT_NEAR(sum, 1.0, 1e-6);
  std::vector<double> seen(weights.size(), 0.0), expected;
  constexpr int n = 1 << 20;
  for (int i = 0; i < n; ++i) {
    const auto choice = d.sample((static_cast<float>(i) + 0.5f) / n);
    seen[choice.index] += 1;
    EXPECT_GE(choice.remapped, 0.0f);
    EXPECT_LT(choice.remapped, 1.0f);
  }
  for (std::uint32_t i = 0; i < weights.size(); ++i) EXPECT_NEAR(seen[i], d.probability(i) * n, 2.0);
}

TEST(DiscreteDistribution, NothingToChooseFromIsEmpty) {
  EXPECT_TRUE(DiscreteDistribution().empty());
  EXPECT_TRUE(DiscreteDistribution(std::vector<double>{0.0, 0.0}).empty());
}

TEST(DiscreteDistribution, NeverChoosesWhatHasNoWeight) {
  const DiscreteDistribution d(std::vector<double>{0.0, 1.0, 0.0});
  for (const float u : {0.0f, 0.5f, 0x1.fffffep-1f}) EXPECT_EQ(d.sample(u).index, 1u);
}

}  // namespace
}  // namespace twopass
