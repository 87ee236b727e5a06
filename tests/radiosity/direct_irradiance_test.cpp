#include "radiosity/direct_irradiance.h"

#include <gtest/gtest.h>

#include "radiosity/subdivision.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

DirectIrradiance direct_of(const Scene& scene, const ElementMesh& mesh, FormFactorMethod method,
                           bool conserve = false) {
  std::uint64_t rays = 0;
  return direct_irradiance(scene, mesh, method, conserve, 0, rays);
}

// Power that arrives at the elements of a shape, W in the first channel.
double power_on(const ElementMesh& mesh, const DirectIrradiance& direct, std::uint32_t shape) {
  double power = 0.0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    if (mesh.root(i).shape == shape) power += mesh.area(i) * direct.irradiance[i].x;
  return power;
}

TEST(DirectIrradiance, ParallelSquaresByAllMethods) {
  const Scene scene(test::plates(1.0f, 0.5f));
  const ElementMesh mesh = divide_surfaces(scene, 400);
  const double truth = 0.19982489569838738;
  EXPECT_NEAR(power_on(mesh, direct_of(scene, mesh, FormFactorMethod::exact), 1), truth, 1e-6);
  EXPECT_NEAR(power_on(mesh, direct_of(scene, mesh, FormFactorMethod::rays), 1), truth, 1e-3);
  EXPECT_NEAR(power_on(mesh, direct_of(scene, mesh, FormFactorMethod::point), 1), truth, 1e-3);
  EXPECT_EQ(power_on(mesh, direct_of(scene, mesh, FormFactorMethod::exact), 0), 0.0);
}

TEST(DirectIrradiance, ShadowsOfABoxAreWhereTheyBelong) {
  SceneDescription description = test::plates(1.0f, 0.5f);
  // A screen halfway that leaves only x > 0.5 of each point's mirror image free.
  test::add_diffuse(description, "screen", test::quad(V3f(-9, -9, 0.5f), V3f(9.5f, 0, 0), V3f(0, 19, 0)),
                    C3f(0.0f));
  const Scene scene(std::move(description));
  const ElementMesh mesh = divide_surfaces(scene, 800);
  const DirectIrradiance direct = direct_of(scene, mesh, FormFactorMethod::exact);
  // By symmetry the screen and its complement share the light equally.
  EXPECT_NEAR(power_on(mesh, direct, 1), 0.5 * 0.19982489569838738, 2e-3);
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    if (mesh.root(i).shape == 1 && mesh.patch(i).centroid().position.x < 0.02) {
      EXPECT_LT(direct.irradiance[i].x, 0.04);  // it sees less than a strip at the far end
    }
}

// A hole in the middle of a screen, and elements much larger than its image: all that comes through it is what
// a point there receives, .55416 of the exitance (a unit square at half its width; Howell's B-3 four times),
// times its area. About a hundred of 65,536 rays get through.
TEST(DirectIrradiance, LightThroughASmallHoleIsFoundByFewElements) {
  constexpr float half = 0.01f;
  SceneDescription description = test::plates(1.0f, 0.5f);
  const auto screen = [&](float x0, float y0, float x1, float y1) {
    test::add_diffuse(description, "screen",
                      test::quad(V3f(x0, y0, 0.5f), V3f(x1 - x0, 0, 0), V3f(0, y1 - y0, 0)), C3f(0.0f));
  };
  screen(-9, -9, 0.5f - half, 9);
  screen(0.5f + half, -9, 9, 9);
  screen(0.5f - half, -9, 0.5f + half, 0.5f - half);
  screen(0.5f - half, 0.5f + half, 0.5f + half, 9);
  const Scene scene(std::move(description));
  const ElementMesh mesh = divide_surfaces(scene, 64);
  constexpr double truth = 4.0 * half * half * 0.55416;
  std::uint64_t usual = 0, rays = 0;
  std::ignore = direct_irradiance(scene, mesh, FormFactorMethod::rays, false, 0, usual);
  const DirectIrradiance direct =
      direct_irradiance(scene, mesh, FormFactorMethod::rays, false, 0, rays, 1u << 16);
  EXPECT_LT(usual, 3000u);
  EXPECT_NEAR(power_on(mesh, direct, 1) / truth, 1.0, 0.35);
}

TEST(DirectIrradiance, ManyEmittersAreSampledToTheSameAnswer) {
  SceneDescription description = test::plates(0.5f, 0.5f);
  Mesh fine;  // the lower plate in 128 triangles
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      const auto base = static_cast<std::uint32_t>(fine.positions.size());
      const Mesh tile = test::quad(V3f(x / 8.0f, y / 8.0f, 0), V3f(0.125f, 0, 0), V3f(0, 0.125f, 0));
      fine.positions.insert(fine.positions.end(), tile.positions.begin(), tile.positions.end());
      fine.triangles.emplace_back(base, base + 1, base + 2);
      fine.triangles.emplace_back(base, base + 2, base + 3);
    }
  description.shapes[0].geometry = fine;
  const Scene scene(std::move(description));
  const ElementMesh mesh = divide_surfaces(scene, 400);
  const DirectIrradiance direct = direct_of(scene, mesh, FormFactorMethod::exact);
  EXPECT_TRUE(direct.exchange_with_lamps.empty());
  EXPECT_NEAR(power_on(mesh, direct, 1), 0.41525328357714674, 2e-3);
}

TEST(DirectIrradiance, OfASphere) {
  SceneDescription description;
  test::add_diffuse(description, "lamp", Sphere{V3f(0, 0, 2), 1.0f, false}, C3f(0.0f), C3f(1.0f / pi_f));
  test::add_diffuse(description, "tile", test::quad(V3f(-0.01f, -0.01f, 0), V3f(0.02f, 0, 0), V3f(0, 0.02f, 0)),
                    C3f(0.5f));
  const Scene scene(std::move(description));
  const DirectIrradiance direct = direct_of(scene, divide_surfaces(scene, 0), FormFactorMethod::exact);
  EXPECT_NEAR(direct.irradiance[0].x, 0.25, 1e-3);
}

TEST(DirectIrradiance, InsideAnEmittingSphereIsItsExitance) {
  SceneDescription description;
  test::add_diffuse(description, "dome", Sphere{V3f(0.0f), 1.0f, true}, C3f(0.5f), C3f(1.0f / pi_f));
  const Scene scene(std::move(description));
  const ElementMesh mesh = divide_surfaces(scene, 64);
  for (const C3d& irradiance : direct_of(scene, mesh, FormFactorMethod::rays).irradiance)
    EXPECT_NEAR(irradiance.x, 1.0, 0.05);
}

TEST(DirectIrradiance, ConservesThePowerOfEveryEmitter) {
  const Scene scene(test::lit_cube(0.5f));
  const ElementMesh mesh = divide_surfaces(scene, 300);
  const DirectIrradiance direct = direct_of(scene, mesh, FormFactorMethod::rays, true);
  double power = 0.0;
  for (std::uint32_t shape = 0; shape < 6; ++shape) power += power_on(mesh, direct, shape);
  EXPECT_NEAR(power, 1.0, 1e-6);
  for (const double exchange : direct.exchange_with_lamps)
    EXPECT_EQ(exchange, 0.0);  // the ceiling has elements
}

TEST(DirectIrradiance, KnowsWhatGoesToLampsThatAreNoElements) {
  const Scene scene(test::lit_room());
  const ElementMesh mesh = divide_surfaces(scene, 500);
  const DirectIrradiance direct = direct_of(scene, mesh, FormFactorMethod::exact);
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    EXPECT_NEAR(direct.exchange_with_lamps[i] * 16.0, direct.irradiance[i].x * mesh.area(i), 1e-6);
}

}  // namespace
}  // namespace twopass
