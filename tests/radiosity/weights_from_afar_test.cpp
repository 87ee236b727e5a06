#include "radiosity/weights_from_afar.h"

#include <gtest/gtest.h>

#include "radiosity/solution.h"
#include "radiosity/subdivision.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

// A wall that stands in a lit room and goes on through its floor, into the dark.
SceneDescription deep_wall() {
  SceneDescription scene = test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.5f));
  const Diffuse white{C3f(0.5f)};
  scene.materials.push_back(two_sided("wall", white, white));
  Shape wall;
  wall.name = "wall";
  wall.geometry = test::quad(V3f(0.6f, 0.01f, -0.06f), V3f(0, 0.98f, 0), V3f(0, 0, 0.98f));
  wall.material = static_cast<std::uint32_t>(scene.materials.size() - 1);
  scene.shapes.push_back(wall);
  return scene;
}

std::vector<Ray> rays_all_around() {
  std::vector<Ray> rays;
  for (std::uint32_t k = 0; k < 512; ++k) {
    Sampler sampler(3, 0, k);
    rays.push_back({V3f(0.2f, 0.5f, 0.5f), unit(square_to_sphere(sampler.next_2d()))});
  }
  return rays;
}

TEST(WeightsFromAfar, NothingIsDrawnWhereNobodySees) {
  const SceneDescription description = deep_wall();
  const Scene scene(description);
  ElementMesh mesh = divide_surfaces(scene, 400);
  std::uint64_t rays = 0;
  mesh.weigh(weights_from_afar(scene, mesh, rays_all_around(), 1, rays));
  EXPECT_GT(rays, 50 * mesh.count());
  const auto wall = static_cast<std::uint32_t>(description.shapes.size() - 1);
  int astride = 0;
  for (std::uint32_t e = 0; e < mesh.count(); ++e) {
    if (mesh.root(e).shape != wall || mesh.is_even_cell(e)) continue;
    double low = 1.0, high = -1.0, lowest_drawn = 1.0, highest_drawn = -1.0, size = mesh.size(e);
    for (const V3d& corner : mesh.patch(e).corner) {
      low = std::min(low, corner.z);
      high = std::max(high, corner.z);
    }
    for (std::uint32_t k = 0; k < 256; ++k) {
      const double z = mesh.sample(e, Sampler(1, e, k).next_2d()).position.z;
      lowest_drawn = std::min(lowest_drawn, z);
      highest_drawn = std::max(highest_drawn, z);
    }
    // To what a byte rounds; above, to a sixteenth's height.
    EXPECT_GT(lowest_drawn, -0.005 * size);
    EXPECT_GT(highest_drawn, high - 0.5 * size);
    if (low < -0.1 * size) ++astride;
  }
  EXPECT_GT(astride, 4);
}

// What a place in a sixteenth is turned into and back, on every kind of surface and both its sides.
TEST(WeightsFromAfar, PointsAreDrawnWhereRaysCame) {
  SceneDescription description;
  test::add_diffuse(description, "flat", test::quad(V3f(-1, -1, 0), V3f(2, 0, 0), V3f(0, 2, 0)), C3f(0.5f));
  test::add_diffuse(description, "ball", Sphere{V3f(4, 0, 0), 1.0f, false}, C3f(0.5f));
  test::add_diffuse(description, "disk", Disk{V3f(8, 0, 0), V3f(1, 0, 0), V3f(0, 1, 0)}, C3f(0.5f));
  test::add_diffuse(description, "can", Cylinder{V3f(12, 0, -1), 1.0f, 2.0f}, C3f(0.5f));
  const Diffuse white{C3f(0.5f)};
  for (Material& material : description.materials) material = two_sided("both", white, white);
  const Scene scene(description);
  ElementMesh mesh = divide_surfaces(scene, 600);
  int sides[4][2] = {};
  for (std::uint32_t k = 0; k < 400; ++k) {
    Sampler sampler(5, 0, k);
    const V2f u = sampler.next_2d();
    const V3f direction = unit(square_to_sphere(sampler.next_2d()));
    const V3f target(4.0f * static_cast<float>(k % 4) + u.x - 0.5f, u.y - 0.5f, 0.0f);
    const Ray ray{target + direction * (k % 3 == 0 ? 0.3f : 3.0f), -direction};
    const Hit hit = scene.caster().intersect(ray);
    if (hit.escaped()) continue;
    const SurfacePoint point = scene.surface_point(ray, hit);
    const ElementMesh::Location at = mesh.locate(point);
    ASSERT_NE(at.element, no_index);
    ++sides[point.shape][point.side];
    const ElementMesh::Sixteenth part = ElementMesh::sixteenth_at(at);
    std::vector<ElementMesh::Weights> weights(mesh.count());
    weights[at.element].count[part.number] = 1;
    weights[at.element].place[part.number] = ElementMesh::Weights::packed(part.u, part.v);
    mesh.weigh(weights);
    const ElementPoint drawn = mesh.sample(at.element, sampler.next_2d());
    EXPECT_LT((drawn.position - V3d(point.position)).length(), 0.01 * mesh.size(at.element)) << point.shape;
    EXPECT_LT(drawn.normal.dot(V3d(ray.direction)), 0.0);
  }
  for (int shape = 0; shape < 4; ++shape)
    for (int side = 0; side < 2; ++side) EXPECT_GT(sides[shape][side], 10) << shape << " " << side;
}

TEST(WeightsFromAfar, AreTheSameOnAnyNumberOfThreads) {
  const Scene scene(deep_wall());
  const ElementMesh mesh = divide_surfaces(scene, 200);
  std::vector<ElementMesh::Weights> found[2];
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    std::uint64_t rays = 0;
    found[threads / 2] = weights_from_afar(scene, mesh, rays_all_around(), 1, rays);
  }
  EXPECT_EQ(found[0], found[1]);
}

// Elements that reach into the dark are as bright as what is seen of them.
TEST(WeightsFromAfar, TheDarkDoesNotDim) {
  const Scene scene(deep_wall());
  const auto irradiance_near_the_floor = [&](std::size_t elements, const std::vector<Ray>& seen) {
    RadiosityOptions options;
    options.rays_per_element = 512;
    ElementMesh mesh = divide_surfaces(scene, elements);
    std::uint64_t rays = 0;
    if (!seen.empty()) mesh.weigh(weights_from_afar(scene, mesh, seen, 1, rays));
    const Solution solution = solve_radiosity_on(scene, mesh, options);
    double sum = 0.0;
    for (int i = 0; i < 40; ++i) {
      const Ray ray{V3f(0.3f, 0.1f + 0.02f * static_cast<float>(i), 0.04f), V3f(1, 0, 0)};
      sum += static_cast<double>(
          solution.irradiance(scene.surface_point(ray, scene.caster().intersect(ray))).total().x);
    }
    return sum / 40.0;
  };
  const double truth = irradiance_near_the_floor(20000, {});
  EXPECT_NEAR(irradiance_near_the_floor(400, rays_all_around()) / truth, 1.0,
              0.12);  // light varies over an element
  EXPECT_LT(irradiance_near_the_floor(400, {}) / truth, 0.85);
}

}  // namespace
}  // namespace twopass
