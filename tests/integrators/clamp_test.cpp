#include "integrators/clamp.h"

#include <gtest/gtest.h>

#include "integrators/path.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

TEST(Clamp, ScalesTheLargestChannelAndKeepsTheColour) {
  const PathLimits limits{.clamp_direct = 2.0f, .clamp_indirect = 1.0f};
  EXPECT_EQ(clamped({1.0f, 4.0f, 2.0f}, 2, limits), C3f(0.5f, 2.0f, 1.0f));
  EXPECT_EQ(clamped({1.0f, 4.0f, 2.0f}, 3, limits), C3f(0.25f, 1.0f, 0.5f));
  EXPECT_EQ(clamped({1.0f, 4.0f, 2.0f}, 100, limits), C3f(0.25f, 1.0f, 0.5f));
  EXPECT_EQ(clamped({1.0f, 4.0f, 2.0f}, 1, limits), C3f(1.0f, 4.0f, 2.0f)) << "seen directly";
  EXPECT_EQ(clamped({0.1f, 0.4f, 0.2f}, 3, limits), C3f(0.1f, 0.4f, 0.2f));
}

TEST(Clamp, IsOffUnlessAskedFor) {
  const float huge = std::numeric_limits<float>::max();
  for (const int edges : {1, 2, 9}) EXPECT_EQ(clamped(C3f(huge), edges, {}), C3f(huge));
}

// Every sample of the clamped path tracer is at most that of the other, at most the clamps allow, and the same
// where nothing is above them.
TEST(Clamp, LimitsWhatThePathTracerAdds) {
  const Scene scene(test::unit_room(C3f(0.7f), C3f(1.0f), C3f(0.7f)));
  const PathTracer free(scene, {.max_depth = 4}), none(scene, {.max_depth = 4, .clamp_indirect = 1e6f}),
      direct(scene, {.max_depth = 2, .clamp_direct = 0.01f}),
      indirect(scene, {.max_depth = 4, .clamp_indirect = 0.001f}), two(scene, {.max_depth = 2});
  RayCounts counts;
  int fewer = 0;
  for (std::uint32_t i = 0; i < 500; ++i) {
    const Ray ray{{0.5f, 0.5f, 0.5f}, unit(V3f(0.3f, 0.2f, -1.0f))};
    const auto seen = [&](const PathTracer& path) {
      Sampler sampler(1, i, 0);
      return path.radiance(ray, sampler, counts).radiance.x;
    };
    const float all = seen(free), of_two = seen(two);
    EXPECT_EQ(seen(none), all);
    EXPECT_LE(seen(direct), 2 * 0.01f * 1.0001f) << "next-event estimation and the scattered ray";
    EXPECT_LE(seen(indirect), of_two + 4 * 0.001f * 1.0001f);
    if (seen(indirect) < all) ++fewer;
  }
  EXPECT_GT(fewer, 100);
}

}  // namespace
}  // namespace twopass
