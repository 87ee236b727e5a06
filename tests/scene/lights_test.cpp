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
    const LightSample s = lights.sample({p, n, true}, sampler.next_2d());
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
  const Receiver receiver{p, V3f(0, 0, 1), false};
  int compared = 0;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    Sampler sampler(6, i, 0);
    const LightSample s = scene.lights().sample(receiver, sampler.next_2d());
    if (!(s.pdf_w > 0.0f) || is_black(s.radiance)) continue;
    const Ray ray{p, s.direction};
    const Hit hit = scene.caster().intersect(ray);
    if (hit.escaped() || std::abs(hit.t - (s.position - p).length()) > 1e-3f * hit.t)
      continue;  // behind another
    const float pdf = scene.lights().pdf_w(receiver, s.direction, hit.t, scene.surface_point(ray, hit));
    EXPECT_NEAR(pdf, s.pdf_w, 2e-3f * s.pdf_w);
    ++compared;
  }
  EXPECT_GT(compared, 1000);
}

// From afar, power decides; each lamp is one light.
TEST(Lights, ChoosesInProportionToPowerFromAfar) {
  SceneDescription scene;
  test::add_diffuse(scene, "small", test::quad(V3f(0, 0, 1), V3f(0, 1, 0), V3f(1, 0, 0)), C3f(0.0f), C3f(9.0f));
  test::add_diffuse(scene, "large", test::quad(V3f(5, 0, 1), V3f(0, 1, 0), V3f(3, 0, 0)), C3f(0.0f), C3f(1.0f));
  const Lights lights(scene.shapes);
  EXPECT_EQ(lights.count(), 2u);
  int from_small = 0;
  for (std::uint32_t i = 0; i < 1200; ++i) {
    Sampler sampler(6, 0, i);
    from_small += lights.sample({V3f(3, 0.5f, -1000), V3f(0, 0, 1), true}, sampler.next_2d()).position.x < 2.0f;
  }
  EXPECT_NEAR(from_small, 900, 10);
}

// A lamp that is seen whole by a diffuse receiver has no noise where it is near, and where it is far the little
// that is cheaper to bear than to remove.
TEST(Lights, UnoccludedLampsHaveLittleNoise) {
  SceneDescription scene;
  test::add_diffuse(scene, "lamp", test::quad(V3f(-0.5f, 0.5f, 1), V3f(1, 0, 0), V3f(0, -1, 0)), C3f(0.0f),
                    C3f(3.0f));
  const Lights lights(scene.shapes);
  const auto noise = [&](const V3f& p, const V3f& n) {
    const test::Estimate e = irradiance(lights, p, n, 2000);
    return std::sqrt(e.variance()) / e.mean();
  };
  const V3f up(0, 0, 1);
  EXPECT_LT(noise(V3f(0, 0, 0.9f), up), 1e-3);
  EXPECT_LT(noise(V3f(1, 0, 0.95f), up), 1e-3);
  EXPECT_LT(noise(V3f(0, 0, 0), V3f(1, 0, 0)), 1e-3) << "half below the horizon";
  EXPECT_LT(noise(V3f(0, 0, 0), up), 0.25);
  EXPECT_LT(noise(V3f(0, 0, -2), up), 0.05);
}

// Two of a kind in every respect, lit from both sides with different radiance.
TEST(Lights, BothSidesOfALampShineAsTheyAre) {
  SceneDescription scene;
  Shape& lamp = test::add_diffuse(scene, "lamp", test::quad(V3f(-0.5f, 0.5f, 1), V3f(1, 0, 0), V3f(0, -1, 0)),
                                  C3f(0.0f), C3f(3.0f));
  lamp.radiance[back] = C3f(5.0f);
  const Lights lights(scene.shapes);
  const test::Estimate below = irradiance(lights, V3f(0, 0, 0), V3f(0, 0, 1), 4000);
  EXPECT_NEAR(below.mean(), 3.0 * pi * 0.23945647046077354, 6 * below.standard_error());
  const test::Estimate above = irradiance(lights, V3f(0, 0, 2), V3f(0, 0, -1), 4000);
  EXPECT_NEAR(above.mean(), 5.0 * pi * 0.23945647046077354, 6 * above.standard_error());
}

// Panel, sphere, point and sky together: the sum of what they send alone.
TEST(Lights, AllKindsTogetherAddUp) {
  SceneDescription scene;
  test::add_diffuse(scene, "lamp", test::quad(V3f(-0.5f, 0.5f, 1), V3f(1, 0, 0), V3f(0, -1, 0)), C3f(0.0f),
                    C3f(3.0f));
  test::add_diffuse(scene, "bulb", Sphere{V3f(4, 0, 3), 1.0f, false}, C3f(0.0f), C3f(2.0f));
  const std::vector<PunctualLight> points{PointLight{V3f(0, 2, 2), C3f(4.0f)}};
  const Environment sky(C3f(0.5f));
  const Lights lights(scene.shapes, points, sky, bounds_of(scene.shapes));
  EXPECT_EQ(lights.count(), 4u);
  test::Estimate e;
  for (std::uint32_t i = 0; i < 200000; ++i) {
    const LightSample s = lights.sample({V3f(0.0f), V3f(0, 0, 1), true}, Sampler(4, i, 0).next_2d());
    e.add(s.pdf_w > 0.0f ? s.radiance.x * std::max(0.0f, s.direction.z) / s.pdf_w : 0.0);
  }
  const double bulb = 2.0 * pi * (1.0 / 25.0) * 0.6, point = 4.0 / 8.0 * std::sqrt(0.5);
  const double exact = 3.0 * pi * 0.23945647046077354 + bulb + point + 0.5 * pi;
  EXPECT_NEAR(e.mean(), exact, 4 * e.standard_error());  // 3e-5 two-sided: 4.2
}

// Directions that see a light have a density, and densities of all that is drawn add up to one: over the sphere
// of directions, lights that are met plus the sky.
TEST(Lights, DensitiesOverAllDirectionsAddUpToOne) {
  SceneDescription description;
  test::add_diffuse(description, "lamp", test::quad(V3f(-0.5f, 0.5f, 1), V3f(1, 0, 0), V3f(0, -1, 0)),
                    C3f(0.0f), C3f(3.0f));
  test::add_diffuse(description, "bulb", Sphere{V3f(3, 0, 1), 0.9f, false}, C3f(0.0f), C3f(1.0f));
  description.environment = Environment(C3f(0.2f));
  const Scene scene(description);
  for (const bool is_diffuse : {true, false}) {
    const Receiver receiver{V3f(0.2f, 0.1f, 0), V3f(0, 0, 1), is_diffuse};
    test::Estimate sum;
    for (std::uint32_t i = 0; i < 200000; ++i) {
      const Ray ray{receiver.position, square_to_sphere(Sampler(12, i, 0).next_2d())};
      const Hit hit = scene.caster().intersect(ray);
      float pdf = 0.0f;
      if (hit.escaped()) {
        pdf = scene.lights().escaped_pdf_w(receiver, ray.direction);
      } else {
        pdf = scene.lights().pdf_w(receiver, ray.direction, hit.t, scene.surface_point(ray, hit));
        // What is behind a lamp is hidden by it: the sky there is drawn, too.
        pdf += scene.lights().escaped_pdf_w(receiver, ray.direction);
        EXPECT_GT(pdf, 0.0f);
      }
      sum.add(4.0 * pi * pdf);
    }
    EXPECT_NEAR(sum.mean(), 1.0, 4.5 * sum.standard_error());
  }
}

// The shadow ray to what is infinitely far away ends outside of everything.
TEST(Lights, SamplesOfTheSkyEndOutside) {
  SceneDescription description = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
  description.environment = Environment(C3f(1.0f));
  const Scene scene(description);
  for (std::uint32_t i = 0; i < 500; ++i) {
    const V3f p(0.5f, 0.5f, 0.5f);
    const LightSample s = scene.lights().sample({p, V3f(0, 0, 1), true}, Sampler(4, i, 0).next_2d());
    EXPECT_FALSE(scene.bounds().intersects(s.position));
    EXPECT_TRUE(scene.caster().occluded(p, s.position));
  }
}

// Ten thousand panels: the irradiance is that of all of them.
TEST(Lights, ManyLampsAddUp) {
  SceneDescription scene;
  Mesh panels;
  constexpr int n = 50;
  double exact = 0.0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const V3f p(static_cast<float>(i) - 25.0f, static_cast<float>(j) - 25.0f,
                  3.0f + static_cast<float>(i % 5));
      const auto base = static_cast<std::uint32_t>(panels.positions.size());
      for (const V3f& q : {p, p + V3f(0, 0.1f, 0), p + V3f(0.1f, 0.1f, 0), p + V3f(0.1f, 0, 0)})
        panels.positions.push_back(q);
      panels.triangles.emplace_back(base, base + 1, base + 2);
      panels.triangles.emplace_back(base, base + 2, base + 3);
      const V3d middle = V3d(p) + V3d(0.05, 0.05, 0.0);
      exact += 0.01 * middle.z * middle.z / std::pow(middle.length2(), 2);  // small enough for the middle to do
    }
  test::add_diffuse(scene, "panels", panels, C3f(0.0f), C3f(1.0f));
  const Lights lights(scene.shapes);
  EXPECT_EQ(lights.count(), static_cast<std::size_t>(n * n));
  const test::Estimate e = irradiance(lights, V3f(0.0f), V3f(0, 0, 1), 20000);
  EXPECT_NEAR(e.mean(), exact, 4.5 * e.standard_error() + 2e-3 * exact);
  EXPECT_LT(std::sqrt(e.variance()) / e.mean(), 1.0);  // by power alone: 1.6
}

TEST(Lights, NoneIsEmpty) { EXPECT_TRUE(Lights(std::span<const Shape>{}).empty()); }

}  // namespace
}  // namespace twopass
