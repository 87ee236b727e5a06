#include "radiosity/caustic_particles.h"

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

C3d power_on(const CausticParticles& particles, std::uint32_t shape) {
  C3d sum(0.0);
  for (const CausticParticle& particle : particles.all())
    if (particle.shape == shape) sum += C3d(particle.power);
  return sum;
}

TEST(CausticParticles, OverAMirrorAreThoseOfTheMirrorImage) {
  const Scene scene(mirrored_lamp());
  const CausticParticles particles(scene, {.particles = std::size_t{1} << 24, .seed = 1});
  // At the middle of the tile, closed form; the tile is too small for its mean to differ by more than 1e-4. Its
  // area is .01.
  const double truth = 0.084353664388 * 0.01, found = power_on(particles, 1).x;
  // Two triangles of one tile: all that arrives. Particles that are aimed differ in what they carry by less
  // than 2.
  const auto hits = static_cast<double>(particles.all().size());
  EXPECT_GT(hits, 5000.0);
  EXPECT_NEAR(found / truth, 1.0, 5.0 / std::sqrt(0.5 * hits));
  for (const CausticParticle& particle : particles.all()) EXPECT_TRUE(particle.is_caustic);
}

TEST(CausticParticles, WithoutSpecularSurfacesThereAreNone) {
  const Scene scene(test::lit_cube(0.5f));
  const CausticParticles particles(scene);
  EXPECT_TRUE(particles.all().empty());
  EXPECT_EQ(particles.rays(), 0u);
}

// All of a lamp's power passes a glass ball around it and lands on the walls.
TEST(CausticParticles, GlassAroundALampPassesItsPower) {
  SceneDescription description = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
  test::add_diffuse(description, "lamp", Sphere{V3f(0.5f), 0.05f, false}, C3f(0.0f), C3f(3.0f, 2.0f, 1.0f));
  description.materials.push_back(interface_material("glass", Dielectric{}));
  const auto glass = static_cast<std::uint32_t>(description.materials.size() - 1);
  description.shapes.push_back({"shell", Sphere{V3f(0.5f), 0.2f, false}, glass, {C3f(0.0f), C3f(0.0f)}});
  const Scene scene(std::move(description));
  const CausticParticles particles(scene, {.particles = 1 << 16, .seed = 1});
  const ElementMesh mesh = divide_surfaces(scene, 500);
  C3d power(0.0);
  for (const CausticParticle& particle : particles.all()) {
    EXPECT_NE(mesh.find(particle.point()), no_index);
    power += C3d(particle.power);
  }
  const double exitance_power = pi * 4.0 * pi * 0.0025;
  // Rays leave the lamp at its surface, not its centre: a few are reflected back onto it and lost.
  EXPECT_NEAR(power.x / (3.0 * exitance_power), 0.96, 0.04);
  EXPECT_LE(power.x, 3.0 * exitance_power * (1.0 + 1e-5));
  EXPECT_NEAR(power.y / power.x, 2.0 / 3.0, 1e-5);
}

// A floor of smooth plastic reflects what Fresnel says of a lamp's light onto the ceiling; that is no caustic.
TEST(CausticParticles, OfCoatsAreNoCaustics) {
  SceneDescription description = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
  test::add_diffuse(description, "lamp", test::quad(V3f(0.4f, 0.4f, 0.9f), V3f(0, 0.2f, 0), V3f(0.2f, 0, 0)),
                    C3f(0.0f), C3f(1.0f));
  description.materials[0] = one_sided("coated", Plastic{});
  const Scene scene(std::move(description));
  const CausticParticles particles(scene, {.seed = 1});
  C3d power(0.0);
  for (const CausticParticle& particle : particles.all()) {
    EXPECT_FALSE(particle.is_caustic);
    EXPECT_NE(particle.shape, 0u);
    power += C3d(particle.power);
  }
  // Of the lamp's pi x .04 W the floor gets .279 (form factor of a point above a square), and reflects .0387 of
  // that at angles as steep as these.
  EXPECT_NEAR(power.x / (pi * 0.04), 0.279 * 0.0387, 3e-4);
}

}  // namespace
}  // namespace twopass
