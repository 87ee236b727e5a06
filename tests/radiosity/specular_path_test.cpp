#include "radiosity/specular_path.h"

#include <gtest/gtest.h>

#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

// A pane of glass of thickness 0.1, and a wall behind it at z = -1 that looks up.
Scene pane(float eta) {
  SceneDescription scene;
  Dielectric glass;
  glass.eta = eta;
  test::add_box(scene, "pane", V3f(-9, -9, 0), V3f(9, 9, 0.1f), interface_material("glass", glass));
  test::add_diffuse(scene, "wall", test::quad(V3f(-99, -99, -1), V3f(198, 0, 0), V3f(0, 198, 0)), C3f(0.5f));
  return Scene(std::move(scene));
}

SpecularPathEnd follow(const Scene& scene, const V3f& direction, Carried carried, std::uint32_t k) {
  const Ray ray{V3f(0.0f, 0.0f, 1.0f), direction};
  Sampler sampler(1, 2, k);
  return follow_specular(scene, ray, scene.surface_point(ray, scene.caster().intersect(ray)), carried, sampler);
}

TEST(SpecularPath, GlassLosesNothingInEitherDirection) {
  const Scene scene = pane(1.5f);
  int transmitted = 0;
  constexpr int paths = 4000;
  for (std::uint32_t k = 0; k < paths; ++k)
    for (const Carried carried : {Carried::radiance, Carried::power}) {
      const SpecularPathEnd end = follow(scene, V3f(0, 0, -1), carried, k);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(end.weight[c], 1.0f, 1e-5f);  // eta^2 on the way in, 1/eta^2 out
      if (!end.escaped && carried == Carried::radiance) ++transmitted;
    }
  // With all internal reflections a pane transmits (1 - R) / (1 + R), R = 0.04.
  EXPECT_NEAR(transmitted / double(paths), 0.96 / 1.04, 5.0 * std::sqrt(0.92 * 0.08 / paths));
}

// Light of a lamp over a rough coat, and over rough metal seen in it: met by chance alone, or sampled as well
// (R52).
TEST(SpecularPath, SampledLampsAreTheLampsMetByChance) {
  RoughPlastic coated;
  coated.alpha = 0.3f;
  coated.distribution = Microfacet::ggx;
  coated.prepare();
  RoughConductor metal;
  metal.alpha_u = metal.alpha_v = 0.2f;
  SceneDescription description;
  description.materials = {one_sided("coated", coated), one_sided("metal", metal),
                           one_sided("black", Diffuse{C3f(0.0f)})};
  description.shapes = {{"floor", test::quad(V3f(-9, -9, 0), V3f(18, 0, 0), V3f(0, 18, 0)), 0, {}},
                        {"wall", test::quad(V3f(1, -9, 0), V3f(0, 0, 9), V3f(0, 18, 0)), 1, {}},
                        {"lamp", test::quad(V3f(0, -0.1f, 1.5f), V3f(0, 0.2f, 0), V3f(0.2f, 0, 0)), 2, {}}};
  description.shapes[2].radiance[front] = C3f(1.0f);
  const Scene scene(std::move(description));
  const Ray ray{V3f(-1.0f, 0.0f, 1.0f), unit(V3f(1.0f, 0.1f, -1.0f))};
  const SurfacePoint start = scene.surface_point(ray, scene.caster().intersect(ray));
  double sum[2] = {}, squares[2] = {};
  constexpr std::uint32_t paths = 100000;
  for (std::uint32_t k = 0; k < paths; ++k)
    for (int samples = 0; samples < 2; ++samples) {
      Sampler sampler(3, static_cast<std::uint32_t>(samples), k, SamplerKind::independent);
      SpecularPath path(scene, ray, start, Carried::radiance, sampler);
      double found = 0.0;
      while (samples ? path.next_with_lamps() : path.next()) {
        const SpecularPathEnd& end = path.end();
        if (end.escaped) break;
        found += static_cast<double>((end.weight * scene.emitted_radiance(end.point)).x * end.lamp_weight);
      }
      found += static_cast<double>(path.sampled().x);
      sum[samples] += found;
      squares[samples] += found * found;
    }
  double mean[2], variance[2];
  for (int i = 0; i < 2; ++i) {
    mean[i] = sum[i] / paths;
    variance[i] = (squares[i] / paths - mean[i] * mean[i]) / paths;
  }
  ASSERT_GT(mean[0], 0.0);
  EXPECT_NEAR(mean[1], mean[0], 4.4 * std::sqrt(variance[0] + variance[1]));
  EXPECT_LT(variance[1], 0.5 * variance[0]);
}

TEST(SpecularPath, EndsInsideOfAMediumWithTheSquareOfItsIndex) {
  SceneDescription description;
  Dielectric water;
  water.eta = 1.33f;
  description.materials = {interface_material("water", water), one_sided("ground", Diffuse{})};
  description.shapes = {{"surface", test::quad(V3f(-9, -9, 0), V3f(18, 0, 0), V3f(0, 18, 0)), 0, {}},
                        {"ground", test::quad(V3f(-9, -9, -1), V3f(18, 0, 0), V3f(0, 18, 0)), 1, {}}};
  const Scene scene(std::move(description));
  int below = 0;
  for (std::uint32_t k = 0; k < 100; ++k) {
    const SpecularPathEnd radiance = follow(scene, V3f(0, 0, -1), Carried::radiance, k);
    const SpecularPathEnd power = follow(scene, V3f(0, 0, -1), Carried::power, k);
    if (radiance.escaped) continue;
    ++below;
    EXPECT_NEAR(radiance.weight.x, 1.0f / (1.33f * 1.33f), 1e-5f);
    EXPECT_NEAR(power.weight.x, 1.0f, 1e-5f);
    EXPECT_EQ(radiance.point.shape, 1u);
  }
  EXPECT_GT(below, 80);
}

TEST(SpecularPath, MirrorsFacingEachOtherDoNotTrapIt) {
  for (const float reflectance : {1.0f, 0.9f}) {
    SceneDescription description;
    Conductor mirror;
    mirror.eta = C3f(0.0f);
    mirror.specular_reflectance = C3f(reflectance);
    description.materials = {one_sided("mirror", mirror)};
    description.shapes = {{"lower", test::quad(V3f(-9, -9, 0), V3f(18, 0, 0), V3f(0, 18, 0)), 0, {}},
                          {"upper", test::quad(V3f(-9, -9, 2), V3f(0, 18, 0), V3f(18, 0, 0)), 0, {}}};
    const Scene scene(std::move(description));
    const SpecularPathEnd end = follow(scene, V3f(0, 0, -1), Carried::radiance, 0);
    EXPECT_TRUE(is_black(end.weight));
    EXPECT_LE(end.rays, 64u);
  }
}

}  // namespace
}  // namespace twopass
