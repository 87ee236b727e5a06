// `path` and `twopass` find the same energy in scenes that nobody has chosen. stress_agreement tries more.
#include "tests/stress/random_scene.h"

#include <gtest/gtest.h>

namespace twopass::stress {
namespace {

class RandomScenes : public testing::TestWithParam<std::uint32_t> {};
TEST_P(RandomScenes, AreAsBrightByPathAndTwoPass) {
  for (std::uint32_t seed = GetParam(); seed < GetParam() + 20; ++seed) {
    const Agreement agreement = compare_integrators(seed);
    EXPECT_EQ(agreement.fault, "") << "seed " << seed;
    EXPECT_TRUE(agreement.holds()) << "seed " << seed << ": twopass / path - 1 = " << agreement.difference
                                   << " +- " << agreement.noise;
    EXPECT_LT(agreement.path.cpu_seconds + agreement.two_pass.cpu_seconds, 20.0 * patience) << "seed " << seed;
  }
}
INSTANTIATE_TEST_SUITE_P(Stress, RandomScenes, testing::Values(0u, 20u, 40u, 60u, 80u));

}  // namespace
}  // namespace twopass::stress
