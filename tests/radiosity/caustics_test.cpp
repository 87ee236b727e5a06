#include "radiosity/caustics.h"

#include <gtest/gtest.h>

#include "radiosity/subdivision.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

// A lamp above a tile, and a mirror beside both: the tile sees the lamp's mirror image.
SceneDescription mirrored_lamp() {
  const V3f x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  SceneDescription scene;
  test::add_diffuse(scene, "lamp", test::quad(z, y, x), C3f(0.0f), C3f(1.0f / pi_f));
  test::add_diffuse(scene, "tile", test::quad(V3f(0.45f, 0.45f, 0), x * 0.1f, y * 0.1f), C3f(0.5f));
  scene.materials.push_back(one_sided("mirror", Conductor{}));
  scene.shapes.push_back(
      {"mirror", test::quad(V3f(0, -9, -9), y * 20.0f, z * 20.0f), 2, {C3f(0.0f), C3f(0.0f)}});
  return scene;
}

TEST(Caustics, OfAMirrorAreThoseOfTheMirrorImage) {
  const Scene scene(mirrored_lamp());
  const ElementMesh mesh = divide_surfaces(scene, 0);
  std::uint64_t rays = 0;
  constexpr std::size_t paths = 1 << 20;
  const std::vector<C3d> irradiance = caustic_irradiance(scene, mesh, paths, 1, rays);
  // At the middle of the tile, closed form; the tile is too small for its mean to differ by more than 1e-4.
  const double truth = 0.084353664388, mean = 0.5 * (irradiance[0].x + irradiance[1].x);
  const double hits = truth * 0.01 * paths;  // each carries 1 / paths of the lamp's one watt
  EXPECT_NEAR(mean / truth, 1.0, 5.0 / std::sqrt(hits));
  EXPECT_GT(rays, paths);
}

TEST(Caustics, WithoutSpecularSurfacesThereAreNone) {
  const Scene scene(test::lit_cube(0.5f));
  std::uint64_t rays = 0;
  for (const C3d& irradiance : caustic_irradiance(scene, divide_surfaces(scene, 100), 1000, 1, rays))
    EXPECT_EQ(irradiance, C3d(0.0));
}

// All of a lamp's power passes a glass ball around it and lands on the walls.
TEST(Caustics, GlassAroundALampPassesItsPower) {
  SceneDescription description = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
  test::add_diffuse(description, "lamp", Sphere{V3f(0.5f), 0.05f, false}, C3f(0.0f), C3f(3.0f, 2.0f, 1.0f));
  description.materials.push_back(interface_material("glass", Dielectric{}));
  const auto glass = static_cast<std::uint32_t>(description.materials.size() - 1);
  description.shapes.push_back({"shell", Sphere{V3f(0.5f), 0.2f, false}, glass, {C3f(0.0f), C3f(0.0f)}});
  const Scene scene(std::move(description));
  const ElementMesh mesh = divide_surfaces(scene, 500);
  std::uint64_t rays = 0;
  const std::vector<C3d> irradiance = caustic_irradiance(scene, mesh, 1 << 16, 1, rays);
  C3d power(0.0);
  for (std::uint32_t i = 0; i < mesh.count(); ++i) power += irradiance[i] * mesh.area(i);
  const double exitance_power = pi * 4.0 * pi * 0.0025;
  // Rays leave the lamp at its surface, not its centre: a few are reflected back onto it and lost.
  EXPECT_NEAR(power.x / (3.0 * exitance_power), 0.96, 0.04);
  EXPECT_LE(power.x, 3.0 * exitance_power * (1.0 + 1e-5));
  EXPECT_NEAR(power.y / power.x, 2.0 / 3.0, 1e-5);
}

}  // namespace
}  // namespace twopass
