// `path` and `twopass` find the same energy in scenes that nobody has chosen. stress_agreement tries more.
#include "tests/stress/random_scene.h"

#include <gtest/gtest.h>

namespace twopass::stress {
namespace {

void expect_agreement(std::uint32_t seed) {
  const Agreement agreement = compare_integrators(seed);
  EXPECT_EQ(agreement.fault, "") << "seed " << seed;
  EXPECT_TRUE(agreement.holds()) << "seed " << seed << ": twopass / path - 1 = " << agreement.difference
                                 << " +- " << agreement.noise;
  EXPECT_LT(agreement.path.cpu_seconds + agreement.two_pass.cpu_seconds, 20.0 * patience) << "seed " << seed;
}

class RandomScenes : public testing::TestWithParam<std::uint32_t> {};
TEST_P(RandomScenes, AreAsBrightByPathAndTwoPass) {
  for (std::uint32_t seed = GetParam(); seed < GetParam() + 20; ++seed) expect_agreement(seed);
}
INSTANTIATE_TEST_SUITE_P(Stress, RandomScenes, testing::Values(0u, 20u, 40u, 60u, 80u));

// Closed places that a disk or a box pokes into, from a sky or a lamp outside: black.
TEST(Stress, DarkRandomScenesStayDark) {
  for (const std::uint32_t seed : {5453u, 20682u, 29027u}) expect_agreement(seed);
}

}  // namespace
}  // namespace twopass::stress
