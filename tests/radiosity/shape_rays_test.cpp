#include "radiosity/shape_rays.h"

#include <gtest/gtest.h>

#include "radiosity/shape_exchange.h"
#include "render/core/parallel.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

constexpr std::uint32_t rays = 1 << 15;

// The number of fronts of j that the rays of i meet, with or without other things in between.
double met(const ShapeRayCounts& counts, std::size_t i, std::size_t j) {
  return static_cast<double>(counts.visible[i][j] + counts.blocked[i][j]);
}

// Five standard deviations of a count of independent rays; stratified ones do better.
void expect_count(double count, double expected) {
  EXPECT_NEAR(count, expected, 5.0 * std::sqrt(expected) + 1e-9);
}

TEST(ShapeRays, GoOnBehindWhatTheyHit) {
  SceneDescription plates = test::plates(1.0f, 0.5f);
  test::add_diffuse(plates, "screen", test::quad(V3f(-9, -9, 0.5f), V3f(9.5f, 0, 0), V3f(0, 19, 0)), C3f(0.0f));
  const Scene scene(plates);
  const ShapeFronts fronts = collect_fronts(scene);
  const ShapeRayCounts counts = count_shape_rays(scene, fronts, rays, true, 1);
  constexpr double parallel = 0.19982489569838738;
  for (const auto& [i, j] : {std::pair{0, 1}, {1, 0}}) {
    expect_count(static_cast<double>(counts.visible[i][j]), 0.5 * parallel * rays);
    expect_count(static_cast<double>(counts.blocked[i][j]), 0.5 * parallel * rays);
  }
  EXPECT_EQ(met(counts, 0, 2), 0.0);  // its back
  EXPECT_GT(counts.met_back, 0u);
  EXPECT_GT(counts.escaped, 0u);
  EXPECT_FALSE(counts.closed());
  const ShapeRayCounts first_only = count_shape_rays(scene, fronts, rays, false, 1);
  EXPECT_EQ(first_only.visible, counts.visible);
  EXPECT_EQ(first_only.blocked[0][1], 0u);
}

TEST(ShapeRays, KnowAClosedRoom) {
  const Scene scene(test::lit_cube(0.5f));
  EXPECT_TRUE(count_shape_rays(scene, collect_fronts(scene), rays, false, 1).closed());
}

TEST(ShapeRays, AreTheSameOnAnyNumberOfThreads) {
  const Scene scene(test::lit_room());
  const ShapeFronts fronts = collect_fronts(scene);
  const auto count = [&](int threads) {
    const ThreadLimit limit(threads);
    return count_shape_rays(scene, fronts, 5000, true, 1);
  };
  const ShapeRayCounts one = count(1), two = count(2);
  EXPECT_EQ(one.visible, two.visible);
  EXPECT_EQ(one.blocked, two.blocked);
}

TEST(ShapeRays, TrianglesWithoutAreaAreCounted) {
  SceneDescription scene = test::plates(1.0f, 0.5f);
  Mesh& mesh = std::get<Mesh>(scene.shapes[0].geometry);
  mesh.triangles.emplace_back(0, 1, 1);
  mesh.triangles.emplace_back(2, 2, 2);
  const Scene built(scene);
  const ShapeFronts fronts = collect_fronts(built);
  EXPECT_EQ(fronts.degenerate, 2u);
  EXPECT_EQ(fronts.patch.size(), 4u);
  EXPECT_EQ(fronts.patches_of(1).size(), 2u);
}

// The closed forms of spheres against the rays' counts.
TEST(ShapeExchange, OfSpheres) {
  SceneDescription description = test::plates(1.0f, 0.5f);
  test::add_diffuse(description, "ball", Sphere{V3f(0.7f, 0.2f, 0.6f), 0.2f, false}, C3f(0.5f));
  test::add_diffuse(description, "shell", Sphere{V3f(0.5f, 0.5f, 0.5f), 4.0f, true}, C3f(0.5f));
  const Scene scene(description);
  const ShapeFronts fronts = collect_fronts(scene);
  const ShapeRayCounts counts = count_shape_rays(scene, fronts, rays, true, 1);
  for (std::uint32_t i = 0; i < 4; ++i)
    for (std::uint32_t j = 0; j < 4; ++j) {
      const std::optional<double> exchange = unoccluded_exchange(scene, fronts, i, j, 1e-10);
      ASSERT_TRUE(exchange.has_value());
      EXPECT_NEAR(*exchange, *unoccluded_exchange(scene, fronts, j, i, 1e-10), 1e-12 * *exchange);
      expect_count(met(counts, i, j), rays * *exchange / fronts.area[i]);
    }
}

// A small surface that faces a sphere at twice its radius: (R / d)^2.
TEST(ShapeExchange, OfASphereAndAnElement) {
  SceneDescription description;
  test::add_diffuse(description, "element", test::quad(V3f(0.0f), V3f(0x1p-12f, 0, 0), V3f(0, 0x1p-12f, 0)),
                    C3f(0.5f));
  test::add_diffuse(description, "ball", Sphere{V3f(0, 0, 2), 1.0f, false}, C3f(0.5f));
  const Scene scene(description);
  const ShapeFronts fronts = collect_fronts(scene);
  EXPECT_NEAR(*unoccluded_exchange(scene, fronts, 0, 1, 1e-10) / fronts.area[0], 0.25, 1e-7);
}

TEST(ShapeExchange, IsUnknownWhereASphereIsPartlyInView) {
  SceneDescription description = test::plates(1.0f, 0.5f);
  test::add_diffuse(description, "sunk", Sphere{V3f(0.5f, 0.5f, 0.1f), 0.2f, false}, C3f(0.5f));
  test::add_diffuse(description, "other", Sphere{V3f(0.5f, 0.5f, 0.8f), 0.1f, false}, C3f(0.5f));
  test::add_diffuse(description, "below", Sphere{V3f(0.5f, 0.5f, -0.8f), 0.1f, false}, C3f(0.5f));
  const Scene scene(description);
  const ShapeFronts fronts = collect_fronts(scene);
  EXPECT_FALSE(unoccluded_exchange(scene, fronts, 0, 2, 1e-10).has_value());
  EXPECT_FALSE(unoccluded_exchange(scene, fronts, 2, 3, 1e-10).has_value());
  EXPECT_EQ(unoccluded_exchange(scene, fronts, 0, 4, 1e-10), 0.0);
  EXPECT_EQ(unoccluded_exchange(scene, fronts, 2, 2, 1e-10), 0.0);
}

}  // namespace
}  // namespace twopass
