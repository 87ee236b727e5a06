#include "radiosity/caustic_map.h"

#include <gtest/gtest.h>

#include "render/core/parallel.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

// A lamp above a floor, and a mirror beside both: the floor sees the lamp's mirror image.
SceneDescription lamp_beside_a_mirror() {
  const V3f x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  SceneDescription scene;
  test::add_diffuse(scene, "lamp", test::quad(z, y, x), C3f(0.0f), C3f(1.0f / pi_f, 2.0f / pi_f, 0.0f));
  test::add_diffuse(scene, "floor", test::quad(V3f(0, -1, 0), x * 2.0f, y * 3.0f), C3f(0.5f));
  scene.materials.push_back(one_sided("mirror", Conductor{}));
  scene.shapes.push_back({"mirror", test::quad(V3f(0, -3, -3), y * 7.0f, z * 7.0f), 2, {C3f(0.0f), C3f(0.0f)}});
  return scene;
}

SurfacePoint floor_at(const Scene& scene, float x, float y) {
  const Ray ray{V3f(x, y, 0.5f), V3f(0, 0, -1)};
  return scene.surface_point(ray, scene.caster().intersect(ray));
}

// The mean over a tile in the middle, where the closed form is that of its own middle within 1e-3.
C3f mean_of_the_tile(const Scene& scene, const CausticMap& map) {
  C3f sum(0.0f);
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 16; ++j)
      sum += map.irradiance(floor_at(scene, 0.45f + 0.1f * (i + 0.5f) / 16, 0.45f + 0.1f * (j + 0.5f) / 16));
  return sum * (1.0f / 256.0f);
}

TEST(CausticMap, OfAMirrorIsThatOfTheMirrorImage) {
  const Scene scene(lamp_beside_a_mirror());
  const CausticMap map(scene, CausticParticles(scene));
  const C3f found = mean_of_the_tile(scene, map);
  constexpr float truth = 0.084353664388f;
  // Some 2000 particles have come to the tile, stratified: five times the error of independent ones is 11 %.
  EXPECT_NEAR(found.x / truth, 1.0f, 0.05f);
  EXPECT_NEAR(found.y / found.x, 2.0f, 1e-4f);
  EXPECT_EQ(found.z, 0.0f);
  // From below nothing is seen of it.
  const Ray up{V3f(0.5f, 0.5f, -0.5f), V3f(0, 0, 1)};
  EXPECT_EQ(map.irradiance(scene.surface_point(up, scene.caster().intersect(up))), C3f(0.0f));
}

TEST(CausticMap, OfFewParticlesIsTheSameButForItsNoise) {
  const Scene scene(lamp_beside_a_mirror());
  const CausticMap map(scene, CausticParticles(scene, {.particles = std::size_t{1} << 16}));
  constexpr float truth = 0.084353664388f;
  // A sixteenth of the particles: four times the error.
  EXPECT_NEAR(mean_of_the_tile(scene, map).x / truth, 1.0f, 0.2f);
}

// Wherever its disk reaches, a particle is found: a small mirror throws the light of a small lamp into the
// middle of the floor, in disks wider than that.
TEST(CausticMap, HoldsThePowerThatHasArrived) {
  const V3f x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  SceneDescription description = lamp_beside_a_mirror();
  description.shapes[0].geometry = test::quad(V3f(1, 0.5f, 1), y * 0.05f, x * 0.05f);
  description.shapes[2].geometry = test::quad(V3f(0, 0.5f, 0.5f), y * 0.05f, z * 0.05f);
  const Scene scene(std::move(description));
  const CausticParticles particles(scene, {.particles = std::size_t{1} << 12});
  const CausticMap map(scene, particles);
  double arrived = 0.0, found = 0.0;
  for (const CausticParticle& particle : particles.all())
    if (particle.is_caustic) arrived += static_cast<double>(particle.power.x);
  constexpr int columns = 256, rows = 384;
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) {
      const float at_x = 2.0f * (static_cast<float>(i) + 0.5f) / columns;
      const float at_y = 3.0f * (static_cast<float>(j) + 0.5f) / rows - 1.0f;
      SurfacePoint point = floor_at(scene, at_x, at_y);
      point.position.z = -1e-7f;
      found += static_cast<double>(map.irradiance(point).x) * 6.0 / (columns * rows);
    }
  EXPECT_GT(map.particles(), 10u);
  EXPECT_NEAR(found / arrived, 1.0, 1e-4);
}

TEST(CausticMap, PartsAddUpByLight) {
  const Scene scene(lamp_beside_a_mirror());
  const CausticMap map(scene, CausticParticles(scene));
  const SurfacePoint point = floor_at(scene, 0.5f, 0.5f);
  C3f sum(0.0f);
  map.visit(point, [&](const C3f& part, std::uint32_t light) {
    EXPECT_EQ(light, 0u);
    sum += part;
  });
  EXPECT_EQ(sum, map.irradiance(point));
}

TEST(CausticMap, WithoutSpecularSurfacesIsEmpty) {
  const Scene scene(test::lit_cube(0.5f));
  EXPECT_TRUE(CausticMap(scene, CausticParticles(scene)).empty());
}

TEST(CausticMap, IsTheSameOnAnyNumberOfThreads) {
  const Scene scene(lamp_beside_a_mirror());
  C3f found[2];
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    found[threads / 2] = mean_of_the_tile(scene, CausticMap(scene, CausticParticles(scene)));
  }
  EXPECT_EQ(found[0], found[1]);
}

}  // namespace
}  // namespace twopass
