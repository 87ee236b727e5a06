#include "render/scene/scene.h"

#include <gtest/gtest.h>

#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

TEST(Scene, SidesAndNormalsFaceTheViewer) {
  const Scene scene(test::unit_room(C3f(0.5f), C3f(2.0f), C3f(0.1f)));
  const Ray up{V3f(0.3f, 0.4f, 0.5f), V3f(0, 0, 1)};
  const SurfacePoint inside = scene.surface_point(up, scene.caster().intersect(up));
  EXPECT_EQ(inside.side, front);
  EXPECT_NEAR((inside.geometric_normal - V3f(0, 0, -1)).length(), 0.0f, 1e-6f);
  EXPECT_EQ(scene.emitted_radiance(inside), C3f(2.0f));
  EXPECT_EQ(scene.side(inside).traits().mean_diffuse_reflectance, C3f(0.1f));

  const Ray down{V3f(0.3f, 0.4f, 5.0f), V3f(0, 0, -1)};
  const SurfacePoint outside = scene.surface_point(down, scene.caster().intersect(down));
  EXPECT_EQ(outside.side, back);
  EXPECT_NEAR((outside.geometric_normal - V3f(0, 0, 1)).length(), 0.0f, 1e-6f);
  EXPECT_TRUE(is_black(scene.emitted_radiance(outside)));
  EXPECT_TRUE(is_black(scene.side(outside).traits().mean_diffuse_reflectance));
}

TEST(Scene, PositionsLieOnTheSurfaceToRounding) {
  SceneDescription description = test::unit_room(C3f(0.5f), C3f(2.0f), C3f(0.1f));
  test::add_diffuse(description, "ball", Sphere{V3f(0.5f), 0.25f, false}, C3f(0.5f));
  const Scene scene(description);
  for (std::uint32_t i = 0; i < 1000; ++i) {
    Sampler sampler(1, i, 0);
    const Ray ray{V3f(0.05f), square_to_sphere(sampler.next_2d())};
    const Hit hit = scene.caster().intersect(ray);
    ASSERT_FALSE(hit.escaped());
    const SurfacePoint p = scene.surface_point(ray, hit);
    EXPECT_NEAR((p.position - (ray.origin + ray.direction * hit.t)).length(), 0.0f, 2e-6f);
    if (scene.shapes()[p.shape].name == "ball") {
      EXPECT_NEAR((p.position - V3f(0.5f)).length(), 0.25f, 1e-7f);
    }
  }
}

// A ray that starts on a surface must neither hit it again nor skip another one close by: at every scale and
// place.
TEST(Scene, SpawnedRaysClearTheirSurfaceAtEveryScaleAndPlace) {
  for (const float scale : {1e-6f, 1.0f, 1e6f}) {
    for (const float shift : {0.0f, 100.0f}) {
      SceneDescription description = test::unit_room(C3f(0.5f), C3f(2.0f), C3f(0.1f));
      for (Shape& shape : description.shapes)
        for (V3f& p : std::get<Mesh>(shape.geometry).positions) p = (p + V3f(shift)) * scale;
      const Scene scene(description);
      int wrong = 0;
      for (std::uint32_t i = 0; i < 20000; ++i) {
        Sampler sampler(1, i, 0);
        const Ray ray{V3f(shift + 0.5f) * scale, square_to_sphere(sampler.next_2d())};
        const Hit hit = scene.caster().intersect(ray);
        if (hit.escaped()) continue;
        const SurfacePoint p = scene.surface_point(ray, hit);
        const V3f w = p.shading.to_world(square_to_cosine_hemisphere(sampler.next_2d()));
        const Hit next = scene.caster().intersect({spawn_position(p, w), w});
        wrong += next.escaped() || next.shape == hit.shape;
      }
      EXPECT_LE(wrong, 2) << "scale " << scale << " shift " << shift;
    }
  }
}

TEST(Scene, InterpolatedNormalsThatFaceAwayDoNotShade) {
  SceneDescription description;
  Mesh mesh = test::quad(V3f(0, 0, 0), V3f(1, 0, 0), V3f(0, 1, 0));
  mesh.normals.assign(4, V3f(1, 0, 0.1f).normalized());
  test::add_diffuse(description, "q", mesh, C3f(0.5f));
  const Scene scene(description);
  for (const V3f& d : {V3f(0, 0, -1), V3f(0.9f, 0, -0.1f), V3f(-0.9f, 0, -0.1f)}) {
    const Ray ray{V3f(0.5f, 0.5f, 0) - d * 0.1f, d.normalized()};
    const SurfacePoint p = scene.surface_point(ray, scene.caster().intersect(ray));
    EXPECT_LT(p.shading.n.dot(ray.direction), 0.0f);
    EXPECT_LT(p.geometric_normal.dot(ray.direction), 0.0f);
  }
}

}  // namespace
}  // namespace twopass
