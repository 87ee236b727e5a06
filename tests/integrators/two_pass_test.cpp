#include "integrators/two_pass.h"

#include <gtest/gtest.h>

#include "integrators/path.h"
#include "radiosity/indirect_field.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

using test::furnished_room;

Solution solve(const Scene& scene, std::size_t elements) {
  RadiosityOptions options;
  options.max_elements = elements;
  options.relative_error = 1e-3;
  return solve_radiosity(scene, options);
}

TEST(TwoPass, AgreesWithThePathTracerInAFurnishedRoom) {
  const Scene scene(furnished_room());
  const Solution solution = solve(scene, 4000);
  const TwoPass two_pass(scene, {&solution}, {});
  const PathTracer path(scene, {});
  for (const V3f& axis : {V3f(0, 1, 0), V3f(0, 0.3f, -1), V3f(-1, 0.5f, 0.2f), V3f(0.3f, 0.2f, 1)}) {
    const test::Estimate ours = test::mean_radiance(two_pass, V3f(0.5f, 0.05f, 0.5f), axis, 0.8f, 60000, 1);
    const test::Estimate truth = test::mean_radiance(path, V3f(0.5f, 0.05f, 0.5f), axis, 0.8f, 120000, 2);
    // Level 1e-5, and the 0.3 % that elements of finite size may be off.
    EXPECT_NEAR(ours.mean(), truth.mean(),
                4.4 * std::hypot(ours.standard_error(), truth.standard_error()) + 0.003 * truth.mean());
  }
}

TEST(TwoPass, HasLessNoiseThanThePathTracer) {
  const Scene scene(furnished_room());
  const Solution solution = solve(scene, 4000);
  const test::Estimate ours = test::mean_radiance(TwoPass(scene, {&solution}, {}), V3f(0.5f, 0.05f, 0.5f),
                                                  V3f(0, 1, 0), 0.999f, 20000, 1);
  const test::Estimate plain =
      test::mean_radiance(PathTracer(scene, {}), V3f(0.5f, 0.05f, 0.5f), V3f(0, 1, 0), 0.999f, 20000, 1);
  EXPECT_LT(ours.variance(), 0.65 * plain.variance());
}

// Where gather rays are drawn changes no mean, and saves noise.
TEST(TwoPass, GathersWhereTheLightComesFrom) {
  const Scene scene(furnished_room());
  const Solution solution = solve(scene, 4000);
  const Guide guide(scene, solution);
  const TwoPass plain(scene, {&solution}, {}), guided(scene, {&solution, nullptr, &guide}, {});
  double noise = 0.0, noise_guided = 0.0;
  for (const V3f& axis : {V3f(0, 1, 0), V3f(0, 0.3f, -1), V3f(-1, 0.5f, 0.2f), V3f(0.3f, 0.2f, 1)}) {
    const test::Estimate a = test::mean_radiance(plain, V3f(0.5f, 0.05f, 0.5f), axis, 0.999f, 40000, 1);
    const test::Estimate b = test::mean_radiance(guided, V3f(0.5f, 0.05f, 0.5f), axis, 0.999f, 40000, 2);
    EXPECT_NEAR(a.mean(), b.mean(), 4.4 * std::hypot(a.standard_error(), b.standard_error()));
    noise += a.variance();
    noise_guided += b.variance();
  }
  EXPECT_LT(noise_guided, 0.9 * noise);
}

// The same room with the indirect light looked up where that is trusted: as right, and with less noise.
TEST(TwoPass, LooksIndirectLightUp) {
  const Scene scene(furnished_room());
  const Solution solution = solve(scene, 4000);
  const IndirectField field(scene, solution);
  const TwoPass gathering(scene, {&solution}, {}), two_pass(scene, {&solution, &field}, {});
  const PathTracer path(scene, {});
  for (const V3f& axis : {V3f(0, 1, 0), V3f(0, 0.3f, -1), V3f(-1, 0.5f, 0.2f), V3f(0.3f, 0.2f, 1)}) {
    const test::Estimate ours = test::mean_radiance(two_pass, V3f(0.5f, 0.05f, 0.5f), axis, 0.8f, 60000, 1);
    const test::Estimate truth = test::mean_radiance(path, V3f(0.5f, 0.05f, 0.5f), axis, 0.8f, 120000, 2);
    EXPECT_NEAR(ours.mean(), truth.mean(),
                4.4 * std::hypot(ours.standard_error(), truth.standard_error()) + 0.005 * truth.mean());
  }
  const auto variance = [&](const Integrator& integrator) {
    return test::mean_radiance(integrator, V3f(0.5f, 0.05f, 0.5f), V3f(0, 1, 0), 0.999f, 20000, 1).variance();
  };
  EXPECT_LT(variance(two_pass), 0.8 * variance(gathering));
}

// The same room with a coat on its floor: diffuse reflection of indirect light is looked up, direct light is
// sampled, the coat is traced. Without (R50), 2 % would be missing: the lamp shines steeply on the floor, and
// the coat lets more of that through than of light from all around.
SceneDescription coated_room() {
  SceneDescription scene = furnished_room();
  RoughPlastic coated;
  coated.base_reflectance = C3f(0.6f, 0.5f, 0.4f);
  coated.alpha = 0.3f;
  coated.prepare();
  scene.materials[0] = one_sided("floor", coated);
  return scene;
}

TEST(TwoPass, LooksUpWhatACoatedFloorDiffuses) {
  const Scene scene(coated_room());
  const Solution solution = solve(scene, 4000);
  const IndirectField field(scene, solution);
  const TwoPass gathering(scene, {&solution}, {}), two_pass(scene, {&solution, &field}, {});
  const PathTracer path(scene, {});
  const V3f eye(0.5f, 0.05f, 0.5f), down(0.2f, 0.8f, -1);
  const test::Estimate ours = test::mean_radiance(two_pass, eye, down, 0.9f, 60000, 1);
  const test::Estimate truth = test::mean_radiance(path, eye, down, 0.9f, 240000, 2);
  EXPECT_NEAR(ours.mean(), truth.mean(),
              4.4 * std::hypot(ours.standard_error(), truth.standard_error()) + 0.003 * truth.mean());
  const test::Estimate gathered = test::mean_radiance(gathering, eye, down, 0.9f, 60000, 1);
  EXPECT_LT(ours.variance(), 0.8 * gathered.variance());
}

TEST(TwoPass, WithoutASolutionItIsAPathTracer) {
  const Scene scene(furnished_room());
  const TwoPass two_pass(scene, {}, {});
  const PathTracer path(scene, {});
  RayCounts a, b;
  for (std::uint32_t i = 0; i < 500; ++i) {
    Sampler first(1, i, 0), second(1, i, 0);
    const Ray ray{V3f(0.5f), square_to_sphere(Sampler(2, i, 0).next_2d())};
    EXPECT_EQ(two_pass.radiance(ray, first, a).radiance, path.radiance(ray, second, b).radiance);
  }
  EXPECT_EQ(a.rays, b.rays);
  EXPECT_EQ(a.shadow_rays, b.shadow_rays);
}

TEST(TwoPass, IsAPureFunctionOfItsArguments) {
  const Scene scene(furnished_room());
  const Solution solution = solve(scene, 1000);
  const TwoPass two_pass(scene, {&solution}, {});
  RayCounts counts;
  for (std::uint32_t i = 0; i < 100; ++i) {
    Sampler first(1, i, 3), second(1, i, 3);
    const Ray ray{V3f(0.5f), square_to_sphere(Sampler(2, i, 0).next_2d())};
    EXPECT_EQ(two_pass.radiance(ray, first, counts).radiance, two_pass.radiance(ray, second, counts).radiance);
  }
}

}  // namespace
}  // namespace twopass
