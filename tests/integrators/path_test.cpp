#include "integrators/path.h"

#include <gtest/gtest.h>

#include "render/core/warp.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

// Irradiance at the middle of a wall of the unit room, from the radiance of cosine-distributed rays: pi times
// their mean.
test::Estimate irradiance(const Integrator& integrator, const V3f& position, const V3f& normal, int samples) {
  test::Estimate estimate;
  RayCounts counts;
  const Frame frame(normal);
  for (int i = 0; i < samples; ++i) {
    Sampler sampler(11, static_cast<std::uint32_t>(i), 0);
    const V3f w = frame.to_world(square_to_cosine_hemisphere(sampler.next_2d()));
    estimate.add(pi * integrator.radiance({position + normal * 1e-5f, w}, sampler, counts).radiance.x);
  }
  return estimate;
}

// Converged radiosities of the unit cube, ceiling emits 1 W/m2, reflectance .5 everywhere.
TEST(PathTracer, UnitCubeIrradiances) {
  const Scene scene(test::unit_room(C3f(0.5f), C3f(1.0f / pi_f), C3f(0.5f)));
  const PathTracer path(scene, {});
  const struct {
    V3f position, normal;
    double truth;
  } cases[] = {
      {{0.5f, 0.5f, 0}, {0, 0, 1}, 0.39521},
      {{0, 0.5f, 0.5f}, {1, 0, 0}, 0.35530},
      {{0.5f, 0.5f, 1}, {0, 0, -1}, 0.18361},
  };
  for (const auto& c : cases) {
    const test::Estimate e = irradiance(path, c.position, c.normal, 200000);
    // Level 1e-5 a case, and the five digits of the table.
    EXPECT_NEAR(e.mean(), c.truth, 4.4 * e.standard_error() + 5e-6);
    EXPECT_LT(e.standard_error() / c.truth, 0.004);
  }
}

// An integrating sphere: lamp of power P at the centre of a sphere of reflectance rho: H = P / (S (1 - rho))
// everywhere.
TEST(PathTracer, LampInASphere) {
  SceneDescription description;
  test::add_diffuse(description, "dome", Sphere{V3f(0.0f), 1.0f, true}, C3f(0.6f));
  test::add_diffuse(description, "lamp", Sphere{V3f(0.0f), 1e-3f, false}, C3f(0.0f), C3f(1e6f));
  const Scene scene(description);
  const double power = 4.0 * pi * 1e-6 * pi * 1e6, surface = 4.0 * pi;
  const PathTracer path(scene, {});
  // Radiance of the wall away from the lamp: rho H / pi.
  const test::Estimate e = test::mean_radiance(path, V3f(0, 0.5f, 0), V3f(0, 1, 0), 0.5f, 100000, 3);
  EXPECT_NEAR(e.mean(), 0.6 / pi * power / (surface * 0.4), 4.4 * e.standard_error());
}

// An ideal mirror returns all of what it sees: light of a square seen in an ideal
// mirror.
TEST(PathTracer, MirrorShowsTheLampInFull) {
  SceneDescription description;
  test::add_diffuse(description, "lamp", test::quad(V3f(-9, 9, 1), V3f(18, 0, 0), V3f(0, -18, 0)), C3f(0.0f),
                    C3f(2.0f));
  test::add_diffuse(description, "mirror", test::quad(V3f(-1, -1, 0), V3f(2, 0, 0), V3f(0, 2, 0)), C3f(0.0f));
  description.materials[1] = one_sided("mirror", Conductor{});
  const Scene scene(description);
  const test::Estimate e =
      test::mean_radiance(PathTracer(scene, {}), V3f(0, 0, 0.5f), V3f(0, 0, -1), 0.95f, 100, 1);
  EXPECT_NEAR(e.mean(), 2.0, 1e-5);
}

// A glass sphere in a uniformly bright world is invisible: nothing is absorbed, and compression cancels.
TEST(PathTracer, GlassInAFurnaceIsInvisible) {
  SceneDescription description;
  description.environment = Environment(C3f(1.0f));
  test::add_diffuse(description, "ball", Sphere{V3f(0.0f), 1.0f, false}, C3f(0.0f));
  description.materials[0] = interface_material("glass", Dielectric{});
  const Scene scene(description);
  const test::Estimate e =
      test::mean_radiance(PathTracer(scene, {}), V3f(0, 0, 3), V3f(0, 0, -1), 0.95f, 20000, 1);
  EXPECT_NEAR(e.mean(), 1.0, 4.4 * e.standard_error() + 1e-5);
  EXPECT_LT(e.standard_error(), 0.01);
}

TEST(PathTracer, DepthCountsEdgesAsMitsuba) {
  const Scene scene(test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.5f)));
  const V3f o(0.5f);
  const auto seen = [&](int depth, const V3f& axis) {
    return test::mean_radiance(PathTracer(scene, {depth, 5, false}), o, axis, 0.9f, 4000, 1).mean();
  };
  EXPECT_EQ(seen(0, V3f(0, 0, 1)), seen(1, V3f(0, 0, 1)));
  EXPECT_EQ(seen(1, V3f(0, 0, 1)), 1.0);  // emitted light
  EXPECT_EQ(seen(1, V3f(0, 0, -1)), 0.0);
  EXPECT_GT(seen(2, V3f(0, 0, -1)), 0.0);  // direct light
  EXPECT_GT(seen(3, V3f(0, 0, -1)), seen(2, V3f(0, 0, -1)));
}

TEST(PathTracer, HiddenEmittersAreDarkButShine) {
  const Scene scene(test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.0f)));
  const PathTracer path(scene, {-1, 5, true});
  EXPECT_EQ(test::mean_radiance(path, V3f(0.5f), V3f(0, 0, 1), 0.9f, 100, 1).mean(), 0.0);
  EXPECT_GT(test::mean_radiance(path, V3f(0.5f), V3f(0, 0, -1), 0.9f, 100, 1).mean(), 0.0);
}

TEST(PathTracer, RouletteChangesNoMean) {
  const Scene scene(test::unit_room(C3f(0.7f), C3f(1.0f), C3f(0.7f)));
  const test::Estimate early =
      test::mean_radiance(PathTracer(scene, {-1, 1, false}), V3f(0.5f), V3f(0, 0, -1), 0.0f, 100000, 1);
  const test::Estimate late =
      test::mean_radiance(PathTracer(scene, {-1, 30, false}), V3f(0.5f), V3f(0, 0, -1), 0.0f, 100000, 2);
  EXPECT_LT(std::abs(test::z_score(early, late)), 4.4);
}

}  // namespace
}  // namespace twopass
