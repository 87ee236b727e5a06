#include "radiosity/certain_light.h"

#include <gtest/gtest.h>

#include "radiosity/lambert.h"
#include "radiosity/solution.h"
#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

// Triangles and quadrilaterals, near and far, large and small: all corners above the receiver's plane, the
// receiver in front.
TEST(LampInView, IsLambertsFormula) {
  Sampler random(5, 0, 0, SamplerKind::independent);
  const auto number = [&](double low, double high) { return low + (high - low) * double(random.next_1d()); };
  double worst = 0.0;
  int beyond_right_angle = 0;
  for (int k = 0; k < 20000; ++k) {
    const double distance = std::pow(10.0, number(-2.0, 4.0)), tilt = number(-0.3, 0.3) * distance;
    const V3d edge1(number(0.5, 1.0), number(-0.2, 0.2), 0), edge2(number(-0.2, 0.2), number(0.5, 1.0), 0);
    const V3d corner = V3d(tilt - 0.5, 0.3 * tilt - 0.5, distance);
    const Polygon polygon = k % 2 == 0
                                ? make_polygon(corner, corner + edge2, corner + edge1)
                                : make_polygon(corner, corner + edge2, corner + edge1 + edge2, corner + edge1);
    const V3f point(0.0f), normal(0.0f, 0.0f, 1.0f);
    const double truth = point_form_factor(V3d(point), V3d(normal), polygon);
    if (distance < 0.2) ++beyond_right_angle;
    worst = std::max(worst, std::abs(LampInView(polygon).form_factor(point, normal) / truth - 1.0));
  }
  EXPECT_GT(beyond_right_angle, 1000);
  EXPECT_LT(worst, 1e-6);
}

// Two lamps, a box in their light, and a room around: at random points of all elements of which it is certain,
// what they receive is what shadow rays to random points of the lamps find.
TEST(CertainLight, IsWhatShadowRaysFind) {
  SceneDescription description = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
  for (const float x : {0.2f, 0.7f})
    test::add_diffuse(description, "lamp", test::quad(V3f(x, 0.4f, 0.98f), V3f(0, 0.15f, 0), V3f(0.1f, 0, 0)),
                      C3f(0.0f), C3f(x, 1.0f, 2.0f));
  test::add_box(description, "box", V3f(0.3f, 0.3f, 0.3f), V3f(0.6f, 0.7f, 0.5f),
                one_sided("box", Diffuse{C3f(0.5f)}));
  const Scene scene(std::move(description));
  const Solution solution = solve_radiosity(scene, {.max_elements = 600, .rays_per_element = 16});
  const CertainLight light(scene, solution.mesh());
  EXPECT_GT(light.share(), 0.3);
  EXPECT_LT(light.share(), 1.0);
  Sampler random(6, 0, 0, SamplerKind::independent);
  double sum = 0.0, squares = 0.0;  // of the relative differences
  int known = 0, dark = 0;
  for (std::uint32_t e = 0; e < solution.mesh().count(); ++e) {
    if (!light.knows(e)) continue;
    ++known;
    const ElementPoint at = solution.mesh().sample(e, random.next_2d());
    C3f exact(0.0f);
    light.visit(e, V3f(at.position), V3f(at.normal), [&](const C3f& arrives, std::uint32_t number) {
      EXPECT_TRUE(is_emitter(scene.shapes()[number]));
      exact += arrives;
    });
    const Receiver receiver{at.ray_position(), V3f(at.normal), true};
    C3d sampled(0.0);
    constexpr int samples = 64;
    for (int k = 0; k < samples; ++k) {
      const LightSample s = scene.lights().sample(receiver, random.next_2d());
      const float cosine = s.direction.dot(receiver.normal);
      if (s.pdf_w > 0.0f && cosine > 0.0f && !scene.caster().occluded(receiver.position, s.position))
        sampled += C3d(s.radiance * (cosine / s.pdf_w)) / samples;
    }
    if (exact.y == 0.0f) {
      ++dark;
      EXPECT_EQ(sampled.y, 0.0) << "element " << e;
      continue;
    }
    const double difference = sampled.y / exact.y - 1.0;
    EXPECT_LT(std::abs(difference), 0.8) << "element " << e;
    sum += difference;
    squares += difference * difference;
  }
  const double n = known - dark, mean = sum / n, error = std::sqrt((squares / n - mean * mean) / n);
  EXPECT_GT(dark, 20);
  EXPECT_GT(n, 100.0);
  EXPECT_LT(error, 0.01);
  EXPECT_LT(std::abs(mean), 3.9 * error);  // level 1e-4
}

TEST(CertainLight, KnowsNothingUnderASkyOrOfCurvedSurfaces) {
  SceneDescription description = test::furnished_room();
  test::add_diffuse(description, "ball", Sphere{V3f(0.7f, 0.3f, 0.2f), 0.15f}, C3f(0.5f));
  SceneDescription sky = description;
  const Scene room(std::move(description));
  const Solution solution = solve_radiosity(room, {.max_elements = 300, .rays_per_element = 4});
  const CertainLight light(room, solution.mesh());
  int known = 0;
  for (std::uint32_t e = 0; e < solution.mesh().count(); ++e) {
    if (!light.knows(e)) continue;
    ++known;
    EXPECT_FALSE(solution.mesh().is_analytic(solution.mesh().root(e).shape));
  }
  EXPECT_GT(known, 0);
  EXPECT_FALSE(light.knows(static_cast<std::uint32_t>(solution.mesh().count())));
  sky.environment = Environment(C3f(1.0f));
  const Scene open(std::move(sky));
  const CertainLight nothing(open, solution.mesh());
  for (std::uint32_t e = 0; e < solution.mesh().count(); ++e) EXPECT_FALSE(nothing.knows(e));
  EXPECT_EQ(nothing.share(), 0.0);
}

}  // namespace
}  // namespace twopass
