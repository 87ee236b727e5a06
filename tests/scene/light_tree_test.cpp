#include "render/scene/light_tree.h"

#include <gtest/gtest.h>

#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

// Random small panels, one-sided and two-sided, and some that shine all around.
std::vector<LightBounds> random_lights(std::uint32_t count, std::uint32_t seed) {
  std::vector<LightBounds> lights(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    Sampler sampler(seed, i, 0);
    const V2f a = sampler.next_2d(), b = sampler.next_2d(), c = sampler.next_2d();
    const V3f center(a.x, a.y, b.x);
    const V3f half = V3f(c.x, c.y, b.y) * 0.02f;
    lights[i].box = Box3f(center - half, center + half);
    lights[i].axis = square_to_sphere(sampler.next_2d());
    lights[i].cos_cone = i % 7 == 0 ? -1.0f : 1.0f;
    lights[i].is_two_sided = i % 3 == 0;
    lights[i].power = 0.1f + sampler.next_1d();
  }
  return lights;
}

Receiver random_receiver(std::uint32_t i) {
  Sampler sampler(77, i, 0);
  const V2f a = sampler.next_2d();
  return {V3f(a.x, a.y, sampler.next_1d()) * 1.6f - V3f(0.3f), square_to_sphere(sampler.next_2d()), i % 2 == 0};
}

TEST(LightTree, ProbabilitiesAddUpToOne) {
  for (const std::uint32_t count : {1u, 2u, 3u, 10u, 500u}) {
    const LightTree tree(random_lights(count, 1));
    for (std::uint32_t r = 0; r < 40; ++r) {
      const Receiver receiver = random_receiver(r);
      double sum = 0.0;
      for (std::uint32_t i = 0; i < count; ++i) sum += tree.probability(receiver, i);
      // Where none of one subtree's lights reaches the receiver, the whole subtree had importance by its
      // bounds.
      EXPECT_LE(sum, 1.0 + 1e-5);
      double drawn = 0.0;
      for (std::uint32_t i = 0; i < 256; ++i)
        drawn += tree.sample(receiver, Sampler(1, r, i).next_2d()).probability > 0.0f;
      // Counts of 256 draws, at 4.5 sigma of independent ones.
      EXPECT_NEAR(sum, drawn / 256, 4.5 * std::sqrt(std::max(0.0, sum * (1.0 - sum)) / 256) + 1e-5);
    }
  }
}

TEST(LightTree, DrawsWithTheStatedProbability) {
  constexpr std::uint32_t count = 60, samples = 20000;
  const LightTree tree(random_lights(count, 2));
  for (std::uint32_t r = 0; r < 10; ++r) {
    const Receiver receiver = random_receiver(r);
    std::vector<double> observed(count), expected(count);
    for (std::uint32_t i = 0; i < count; ++i) expected[i] = tree.probability(receiver, i) * samples;
    double none = samples;
    for (const double e : expected) none -= e;
    for (std::uint32_t i = 0; i < samples; ++i) {
      const LightTree::Choice choice = tree.sample(receiver, Sampler(1, i, r).next_2d());
      if (!(choice.probability > 0.0f)) continue;
      observed[choice.light] += 1.0;
      EXPECT_NEAR(choice.probability, tree.probability(receiver, choice.light), 1e-5f * choice.probability);
      EXPECT_TRUE(choice.remapped >= 0.0f && choice.remapped < 1.0f);
    }
    if (none > 0.9 * samples) continue;  // nothing to be compared: all lights are behind the receiver
    if (none > 5.0) {
      double drawn = 0.0;
      for (const double o : observed) drawn += o;
      observed.push_back(samples - drawn);
      expected.push_back(none);
    }
    EXPECT_GT(test::chi2_test(observed, expected), test::sidak(1e-4, 10)) << r;
  }
}

// A light of which any point sends anything to the receiver has a chance.
TEST(LightTree, NeverExcludesALightThatShines) {
  constexpr std::uint32_t count = 300;
  const auto lights = random_lights(count, 3);
  const LightTree tree(lights);
  int shining = 0;
  for (std::uint32_t r = 0; r < 100; ++r) {
    const Receiver receiver = random_receiver(r);
    for (std::uint32_t i = 0; i < count; ++i) {
      const LightBounds& light = lights[i];
      bool shines = false;
      for (int corner = 0; corner < 8; ++corner) {
        const V3f p(corner & 1 ? light.box.max.x : light.box.min.x,
                    corner & 2 ? light.box.max.y : light.box.min.y,
                    corner & 4 ? light.box.max.z : light.box.min.z);
        const V3f to_light = p - receiver.position;
        const float emitted = -to_light.dot(light.axis);
        shines =
            shines || ((light.cos_cone == -1.0f || emitted > 0.0f || (light.is_two_sided && emitted != 0.0f)) &&
                       (!receiver.is_diffuse || to_light.dot(receiver.normal) > 0.0f));
      }
      EXPECT_TRUE(!shines || tree.probability(receiver, i) > 0.0f);
      shining += shines;
    }
  }
  EXPECT_GT(shining, 10000);
}

TEST(LightTree, LightsInOnePlaceAndOneLineAreChosenToo) {
  std::vector<LightBounds> lights(1000);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    lights[i].box = Box3f(V3f(1, 2, i < 500 ? 3.0f : static_cast<float>(i)));
    lights[i].power = 1.0f;
  }
  const LightTree tree(lights);
  for (const V3f& p : {V3f(1, 2, 3), V3f(0, 0, 0), V3f(1, 2, 1e6f)}) {
    const Receiver receiver{p, V3f(0, 0, 1), false};
    double sum = 0.0;
    for (std::uint32_t i = 0; i < 1000; ++i) {
      const float probability = tree.probability(receiver, i);
      EXPECT_TRUE(std::isfinite(probability) && probability > 0.0f);
      sum += probability;
    }
    EXPECT_NEAR(sum, 1.0, 1e-4);
  }
}

// Among equal lamps a near one is chosen more often than its share.
TEST(LightTree, PrefersWhatIsNear) {
  std::vector<LightBounds> lights(64);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    lights[i].box = Box3f(V3f(static_cast<float>(i), 0, 1));
    lights[i].power = 1.0f;
  }
  const LightTree tree(lights);
  const Receiver receiver{V3f(0.0f), V3f(0, 0, 1), true};
  EXPECT_GT(tree.probability(receiver, 0), 10.0f / 64.0f);
  EXPECT_LT(tree.probability(receiver, 63), 0.1f / 64.0f);
}

}  // namespace
}  // namespace twopass
