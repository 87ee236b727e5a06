#include "render/scene/lights.h"

#include <gtest/gtest.h>

#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "render/scene/scene.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

// Irradiance at p with normal n by sampling the lights, nothing in between.
test::Estimate irradiance(const Lights& lights, const V3f& p, const V3f& n, int samples) {
  test::Estimate e;
  for (int i = 0; i < samples; ++i) {
    Sampler sampler(5, static_cast<std::uint32_t>(i), 0);
    const LightSample s = lights.sample(p, sampler.next_2d());
    e.add(s.pdf_w > 0.0f ? s.radiance.x * std::max(0.0f, s.direction.dot(n)) / s.pdf_w : 0.0);
  }
  return e;
}

// Lambert's formula: a unit square at distance 1 above its centre fills 0.23945647046077354
// of the cosine-weighted hemisphere.
TEST(Lights, QuadGivesLambertsIrradiance) {
  SceneDescription scene;
  test::add_diffuse(scene, "lamp", test::quad(V3f(-0.5f, 0.5f, 1), V3f(1, 0, 0), V3f(0, -1, 0)), C3f(0.0f),
                    C3f(3.0f));
  const test::Estimate e = irradiance(Lights(scene.shapes), V3f(0, 0, 0), V3f(0, 0, 1), 100000);
  EXPECT_NEAR(e.mean(), 3.0 * pi * 0.23945647046077354, 5 * e.standard_error());
}

TEST(Lights, BackOfAOneSidedLampIsDark) {
  SceneDescription scene;
  test::add_diffuse(scene, "lamp", test::quad(V3f(-0.5f, 0.5f, 1), V3f(1, 0, 0), V3f(0, -1, 0)), C3f(0.0f),
                    C3f(3.0f));
  EXPECT_EQ(irradiance(Lights(scene.shapes), V3f(0, 0, 2), V3f(0, 0, -1), 100).mean(), 0.0);
}

// A sphere of radius 1 at distance 2 fills 0.25; no noise but the cosine's, thanks to the
// cone.
TEST(Lights, SphereGivesItsExactIrradiance) {
  SceneDescription scene;
  test::add_diffuse(scene, "bulb", Sphere{V3f(0, 0, 2), 1.0f, false}, C3f(0.0f), C3f(3.0f));
  const Lights lights(scene.shapes);
  const test::Estimate e = irradiance(lights, V3f(0.0f), V3f(0, 0, 1), 20000);
  EXPECT_NEAR(e.mean(), 3.0 * pi * 0.25, 5 * e.standard_error());
  EXPECT_LT(std::sqrt(e.variance()) / e.mean(), 0.06);
}

TEST(Lights, InsideOfASphereIsUniformlyBright) {
  SceneDescription scene;
  test::add_diffuse(scene, "dome", Sphere{V3f(0.0f), 1.0f, true}, C3f(0.0f), C3f(1.0f));
  const Lights lights(scene.shapes);
  const test::Estimate e = irradiance(lights, V3f(0.3f, 0.2f, -0.1f), V3f(0, 0.6f, 0.8f), 400000);
  EXPECT_NEAR(e.mean(), pi, 5 * e.standard_error());
}

// On the sphere itself rounding must not decide between inside and outside: from any point of it the irradiance
// is pi.
TEST(Lights, OnTheSurfaceOfASphereItIsUniformlyBrightToo) {
  SceneDescription scene;
  test::add_diffuse(scene, "dome", Sphere{V3f(0.3f, 0.1f, -0.2f), 1.0f, true}, C3f(0.0f), C3f(1.0f));
  const Lights lights(scene.shapes);
  for (std::uint32_t i = 0; i < 20; ++i) {
    const V3f outward = square_to_sphere(Sampler(9, i, 0).next_2d());
    const test::Estimate e = irradiance(lights, V3f(0.3f, 0.1f, -0.2f) + outward, -outward, 2000);
    // The kernel is constant: every sample gives the same.
    EXPECT_NEAR(e.mean(), pi, 0.01);
  }
}

// The density that sample() reports is the one that pdf_w() gives for what the shadow ray would hit.
TEST(Lights, PdfOfAHitIsThatOfTheSample) {
  SceneDescription description;
  test::add_diffuse(description, "lamp", test::quad(V3f(-0.5f, 0.5f, 1), V3f(1, 0, 0), V3f(0, -1, 0)),
                    C3f(0.0f), C3f(3.0f));
  test::add_diffuse(description, "bulb", Sphere{V3f(2, 0, 0), 0.3f, false}, C3f(0.0f), C3f(1.0f));
  test::add_diffuse(description, "dome", Sphere{V3f(0.0f), 9.0f, true}, C3f(0.0f), C3f(0.1f));
  const Scene scene(description);
  const V3f p(0.1f, 0.2f, 0.05f);
  int compared = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    Sampler sampler(6, i, 0);
    const LightSample s = scene.lights().sample(p, sampler.next_2d());
    if (!(s.pdf_w > 0.0f) || is_black(s.radiance)) continue;
    const Ray ray{p, s.direction};
    const Hit hit = scene.caster().intersect(ray);
    if (hit.escaped() || std::abs(hit.t - (s.position - p).length()) > 1e-3f * hit.t)
      continue;  // behind another
    const float pdf = scene.lights().pdf_w(p, s.direction, hit.t, scene.surface_point(ray, hit));
    EXPECT_NEAR(pdf, s.pdf_w, 2e-3f * s.pdf_w);
    ++compared;
  }
  EXPECT_GT(compared, 1000);
}

TEST(Lights, ChoosesInProportionToPower) {
  SceneDescription scene;
  test::add_diffuse(scene, "small", test::quad(V3f(0, 0, 1), V3f(0, 1, 0), V3f(1, 0, 0)), C3f(0.0f), C3f(9.0f));
  test::add_diffuse(scene, "large", test::quad(V3f(0, 0, 2), V3f(0, 1, 0), V3f(3, 0, 0)), C3f(0.0f), C3f(1.0f));
  const Lights lights(scene.shapes);
  EXPECT_EQ(lights.count(), 4u);
  int from_small = 0;
  for (std::uint32_t i = 0; i < 1200; ++i) {
    Sampler sampler(6, 0, i);
    from_small += lights.sample(V3f(0.5f, 0.5f, 0), sampler.next_2d()).position.z < 1.5f;
  }
  EXPECT_NEAR(from_small, 900, 3);
}

TEST(Lights, NoneIsEmpty) { EXPECT_TRUE(Lights(std::span<const Shape>{}).empty()); }

}  // namespace
}  // namespace twopass
