#include "radiosity/lamp_light.h"

#include <bit>

#include <gtest/gtest.h>

#include "radiosity/patch.h"
#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

Polygon triangle(const V3f& a, const V3f& b, const V3f& c) { return make_polygon(V3d(a), V3d(b), V3d(c)); }

// A triangle of the floor around (x, y).
Polygon on_floor(float x, float y, float size = 0.02f) {
  return triangle(V3f(x, y, 0), V3f(x + size, y, 0), V3f(x, y + size, 0));
}

TEST(LampLight, IsTheIrradianceUnderASquareInFullView) {
  const Scene scene(test::unit_room(C3f(0.5f), C3f(1.0f / pi_f, 2.0f / pi_f, 0.0f), C3f(0.5f)));
  const LampLight light(scene);
  ASSERT_TRUE(light.is_known());
  const auto seen = light.seen_from(on_floor(0.5f, 0.5f));
  ASSERT_TRUE(seen.has_value());
  const C3d irradiance = light.irradiance(V3d(0.5, 0.5, 0), V3d(0, 0, 1), *seen);
  EXPECT_NEAR(irradiance.x, 0.239456470461, 1e-7);  // form factor of the square from the middle
  EXPECT_NEAR(irradiance.y, 2 * 0.239456470461, 2e-7);
  EXPECT_EQ(irradiance.z, 0.0);
  // The ceiling does not see itself.
  EXPECT_EQ(light.seen_from(triangle(V3f(0.1f, 0.1f, 1), V3f(0.1f, 0.2f, 1), V3f(0.2f, 0.1f, 1))),
            LampLight::Lamps{0});
}

TEST(LampLight, ASlabHidesALampWhollyPartlyOrNot) {
  SceneDescription description = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
  test::add_diffuse(description, "lamp", test::quad(V3f(0.4f, 0.4f, 0.999f), V3f(0, 0.2f, 0), V3f(0.2f, 0, 0)),
                    C3f(0.0f), C3f(1.0f));
  test::add_box(description, "slab", V3f(0.35f, 0.35f, 0.8f), V3f(0.65f, 0.65f, 0.82f),
                one_sided("slab", Diffuse{C3f(0.5f)}));
  const Scene scene(std::move(description));
  const LampLight light(scene);
  EXPECT_EQ(light.seen_from(on_floor(0.49f, 0.49f)), LampLight::Lamps{0});
  EXPECT_EQ(light.seen_from(on_floor(0.95f, 0.49f)), std::nullopt);  // half shadow
  // High on the wall, above the slab's edge.
  const auto high = light.seen_from(triangle(V3f(0, 0.5f, 0.95f), V3f(0, 0.52f, 0.95f), V3f(0, 0.5f, 0.97f)));
  ASSERT_TRUE(high.has_value());
  EXPECT_EQ(std::popcount(*high), 1);
  EXPECT_GT(light.irradiance(V3d(0, 0.5, 0.95), V3d(1, 0, 0), *high).x, 0.0);
}

// What is said of a triangle holds for every ray from it to every lamp, in a room full of boxes at random.
TEST(LampLight, EveryRayAgrees) {
  int hidden = 0, in_view = 0;
  for (std::uint32_t room = 0; room < 6; ++room) {
    SceneDescription description = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
    Sampler random(17, room, 0, SamplerKind::independent);
    const auto number = [&](float low, float high) { return low + (high - low) * random.next_1d(); };
    const std::size_t first_lamp = description.shapes.size();
    for (int k = 0; k < 3; ++k)
      test::add_diffuse(description, "lamp",
                        test::quad(V3f(number(0.05f, 0.85f), number(0.05f, 0.85f), number(0.9f, 0.99f)),
                                   V3f(0, 0.1f, 0), V3f(0.1f, 0, 0)),
                        C3f(0.0f), C3f(1.0f));
    for (int k = 0; k < 5; ++k) {
      const V3f low(number(0, 0.7f), number(0, 0.7f), number(0, 0.7f));
      test::add_box(description, "box", low,
                    low + V3f(number(0.05f, 0.3f), number(0.05f, 0.3f), number(0.02f, 0.15f)),
                    one_sided("box", Diffuse{C3f(0.5f)}));
    }
    const Scene scene(description);
    const LampLight light(scene);
    for (int t = 0; t < 300; ++t) {
      const float s = 0.03f;
      const V3f p(number(0, 0.95f), number(0, 0.95f), 0), q(0, number(0, 0.95f), number(0, 0.85f));
      const bool floor = t % 2 == 0;
      const V3f corner = floor ? p : q, a = floor ? V3f(s, 0, 0) : V3f(0, s, 0),
                b = floor ? V3f(0, s, 0) : V3f(0, 0, s);
      const Polygon polygon = triangle(corner, corner + a, corner + b);
      const auto seen = light.seen_from(polygon);
      if (!seen) continue;
      const Patch patch = triangle_patch({corner, corner + a, corner + b}, front);
      for (std::uint32_t lamp = 0; lamp < 3; ++lamp) {
        const bool is_seen = *seen >> lamp & 1;
        const auto& at = std::get<Mesh>(description.shapes[first_lamp + lamp].geometry).positions;
        for (int k = 0; k < 32; ++k) {
          const ElementPoint start = patch.sample(random.next_2d());
          const V2f u = random.next_2d();
          const V3f end = at[0] + (at[1] - at[0]) * u.x + (at[3] - at[0]) * u.y - V3f(0, 0, 1e-5f);
          EXPECT_NE(scene.caster().occluded(start.ray_position(), end), is_seen);
        }
        ++(is_seen ? in_view : hidden);
      }
    }
  }
  EXPECT_GT(in_view, 200);
  EXPECT_GT(hidden, 50);
}

TEST(LampLight, TakesBallsForTheBoxesAroundThem) {
  SceneDescription description = test::furnished_room();
  test::add_diffuse(description, "ball", Sphere{V3f(0.7f, 0.3f, 0.2f), 0.15f}, C3f(0.5f));
  const Scene scene(std::move(description)), without(test::furnished_room());
  const Polygon below = on_floor(0.7f, 0.3f), aside = on_floor(0.7f, 0.9f);
  EXPECT_NE(LampLight(without).seen_from(below), std::nullopt);
  EXPECT_EQ(LampLight(scene).seen_from(below), std::nullopt);
  EXPECT_EQ(LampLight(scene).seen_from(aside), LampLight(without).seen_from(aside));
  EXPECT_NE(LampLight(scene).seen_from(aside), std::nullopt);
}

TEST(LampLight, KnowsNothingOfOtherLights) {
  EXPECT_TRUE(LampLight(Scene(test::furnished_room())).is_known());
  SceneDescription sky = test::furnished_room(), punctual = sky, ball = sky, masked = sky, dark = sky,
                   crowded = sky;
  sky.environment = Environment(C3f(1.0f));
  punctual.punctual_lights.push_back(PointLight{V3f(0.5f), C3f(1.0f)});
  test::add_diffuse(ball, "ball", Sphere{V3f(0.7f, 0.3f, 0.2f), 0.05f}, C3f(0.5f), C3f(1.0f));
  masked.materials[0] = material_of("hole", MaterialSide(Null{}));
  for (Shape& shape : dark.shapes) shape.radiance = {C3f(0.0f), C3f(0.0f)};
  for (int k = 0; k < 400; ++k)
    test::add_box(crowded, "box", V3f(0.1f), V3f(0.2f), one_sided("box", Diffuse{C3f(0.5f)}));
  for (const SceneDescription& scene : {sky, punctual, ball, masked, dark, crowded})
    EXPECT_FALSE(LampLight(Scene(scene)).is_known());
}

}  // namespace
}  // namespace twopass
