#include "radiosity/visibility.h"

#include <gtest/gtest.h>

#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

// Two parallel triangles at the distance 1, and perhaps a screen between them that covers x < `edge`.
struct Screened {
  Scene scene;
  Patch a, b;

  explicit Screened(float edge) : scene(describe(edge)) {
    a = triangle_patch(std::get<Mesh>(scene.shapes()[0].geometry), 0, front);
    b = triangle_patch(std::get<Mesh>(scene.shapes()[1].geometry), 0, front);
  }
  static SceneDescription describe(float edge) {
    SceneDescription scene = test::plates(1.0f, 0.5f);
    test::add_diffuse(scene, "screen", test::quad(V3f(-9, -9, 0.5f), V3f(edge + 9, 0, 0), V3f(0, 20, 0)),
                      C3f(0.0f));
    return scene;
  }
  [[nodiscard]] double fraction(std::uint32_t key, std::uint32_t pairs, std::uint64_t& rays) const {
    return visible_fraction(scene.caster(), a, b, key, pairs, rays);
  }
};

TEST(Visibility, AllOrNothing) {
  std::uint64_t rays = 0;
  EXPECT_EQ(Screened(-5.0f).fraction(1, 4, rays), 1.0);
  EXPECT_EQ(rays, 4u);
  EXPECT_EQ(Screened(5.0f).fraction(1, 4, rays), 0.0);
  EXPECT_EQ(rays, 8u);
}

// A gap matters as much as its share, however rarely it is found.
TEST(Visibility, APartlyHiddenPairIsEstimatedWithoutBias) {
  for (const float edge : {0.6f, 0.9f}) {
    const Screened screened(edge);
    std::uint64_t rays = 0;
    const double truth = screened.fraction(0, 1 << 16, rays);
    EXPECT_GT(truth, 0.005);
    EXPECT_LT(truth, 0.6);
    double mean = 0.0;
    constexpr std::uint32_t estimates = 4000;
    for (std::uint32_t key = 0; key < estimates; ++key) mean += screened.fraction(key, 16, rays) / estimates;
    // Five standard deviations of pairs taken one by one; stratified ones do better.
    EXPECT_NEAR(mean / truth, 1.0, 5.0 / std::sqrt(16.0 * estimates * truth)) << edge;
  }
}

TEST(Visibility, TurnedAwayMeansNothing) {
  const Screened open(-5.0f);
  const Patch behind = triangle_patch(std::get<Mesh>(open.scene.shapes()[1].geometry), 0, back);
  std::uint64_t rays = 0;
  EXPECT_EQ(visible_fraction(open.scene.caster(), open.a, behind, 1, 4, rays), 0.0);
  EXPECT_EQ(rays, 0u);
}

}  // namespace
}  // namespace twopass
