#include "radiosity/subdivision.h"

#include <gtest/gtest.h>

#include "render/core/sampler.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

TEST(Subdivision, OnlySidesThatHoldARadiosityHaveElements) {
  SceneDescription scene;
  const V3f x(1, 0, 0), y(0, 1, 0);
  test::add_diffuse(scene, "one-sided", test::quad(V3f(0.0f), x, y), C3f(0.5f));
  test::add_diffuse(scene, "black lamp", test::quad(V3f(0, 0, 1), y, x), C3f(0.0f), C3f(1.0f));
  scene.materials.push_back(two_sided("mirror", Conductor{}, Diffuse{C3f(0.5f)}));
  scene.shapes.push_back({"mirror", test::quad(V3f(0, 0, 2), y, x), 2, {C3f(0.0f), C3f(0.0f)}});
  scene.materials.push_back(interface_material("glass", Dielectric{}));
  scene.shapes.push_back({"glass", test::quad(V3f(0, 0, 3), y, x), 3, {C3f(0.0f), C3f(0.0f)}});
  const ElementMesh mesh = divide_surfaces(Scene(std::move(scene)), 0);
  EXPECT_TRUE(mesh.has_elements(0, front));
  EXPECT_FALSE(mesh.has_elements(0, back));
  EXPECT_FALSE(mesh.has_elements(1, front));
  EXPECT_FALSE(mesh.has_elements(2, front));
  EXPECT_TRUE(mesh.has_elements(2, back));
  EXPECT_FALSE(mesh.has_elements(3, front));
  EXPECT_FALSE(mesh.has_elements(3, back));
  EXPECT_EQ(mesh.count(), 4u);
}

TEST(Subdivision, UsesMostOfTheBudgetAndNeverMore) {
  const Scene scene(test::lit_room());
  for (const std::size_t most : {100, 333, 1000, 8192, 50000}) {
    const ElementMesh mesh = divide_surfaces(scene, most);
    EXPECT_LE(mesh.count(), most);
    EXPECT_GE(mesh.count(), most / 2) << most;
  }
}

TEST(Subdivision, ElementsAreOfAboutOneSize) {
  const Scene scene(test::lit_room());
  const ElementMesh mesh = divide_surfaces(scene, 8192);
  double smallest = infinity_f, largest = 0.0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    smallest = std::min(smallest, mesh.area(i));
    largest = std::max(largest, mesh.area(i));
  }
  EXPECT_LE(largest / smallest, 4.0 + 1e-9);
}

TEST(Subdivision, GridsOfNeighboursNest) {
  const Scene scene(test::lit_room());
  for (const std::size_t most : {1000, 5000, 8192, 30000}) {
    const ElementMesh mesh = divide_surfaces(scene, most);
    for (const ElementRoot& a : mesh.roots())
      for (const ElementRoot& b : mesh.roots()) {
        const bool comparable = a.divisions > 0 && b.divisions >= a.divisions;
        EXPECT_EQ(comparable ? b.divisions % a.divisions : 0, 0) << most;
      }
  }
}

TEST(Subdivision, WithoutABudgetEveryTriangleSideIsAnElement) {
  const ElementMesh mesh = divide_surfaces(Scene(test::lit_room()), 0);
  EXPECT_EQ(mesh.count(), 2u * (6 + 10));
  for (std::uint32_t i = 0; i < mesh.count(); ++i) EXPECT_FALSE(mesh.is_cluster(i));
}

// A floor of 2 n^2 small triangles, wavy, in a room; the same floor again a little below it, facing down.
SceneDescription fine_floor(int n) {
  SceneDescription scene = test::lit_room();
  Mesh mesh;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(n),
                  v = static_cast<float>(y) / static_cast<float>(n);
      mesh.positions.emplace_back(u, v, 0.1f + 0.01f * std::sin(20.0f * u) * std::cos(17.0f * v));
    }
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
      mesh.triangles.emplace_back(at(x, y), at(x + 1, y), at(x + 1, y + 1));
      mesh.triangles.emplace_back(at(x, y), at(x + 1, y + 1), at(x, y + 1));
    }
  scene.materials = {two_sided("grey", Diffuse{C3f(0.5f)}, Diffuse{C3f(0.3f)})};
  for (Shape& shape : scene.shapes) shape.material = 0;
  scene.shapes.push_back({"floor", std::move(mesh), 0, {C3f(0.0f), C3f(0.0f)}});
  return scene;
}

TEST(Subdivision, SmallTrianglesJoinInClusters) {
  const Scene scene(fine_floor(200));
  const ElementMesh mesh = divide_surfaces(scene, 4000);
  EXPECT_LE(mesh.count(), 4000u);
  EXPECT_GE(mesh.count(), 2000u);
  std::vector<int> seen(mesh.roots().size(), 0);
  double cluster_area = 0.0;
  std::size_t clusters = 0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    if (!mesh.is_cluster(i)) continue;
    ++clusters;
    cluster_area += mesh.area(i);
    ASSERT_GE(mesh.members(i).size(), 2u);
    V3d low(infinity_f), high(-infinity_f);
    for (std::size_t k = 0; k < mesh.patch_count(i); ++k) {
      const ElementRoot& root = mesh.roots()[mesh.members(i)[k]];
      ++seen[mesh.members(i)[k]];
      EXPECT_EQ(root.first_element, i);
      EXPECT_EQ(root.side, mesh.root(i).side);
      const Patch patch = mesh.patch(i, k);
      EXPECT_GT(patch.normal.dot(mesh.patch(i, 0).normal), 0.7);
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], patch.centroid().position[axis]);
        high[axis] = std::max(high[axis], patch.centroid().position[axis]);
      }
    }
    EXPECT_LT((high - low).length(), 3.0 * 0.06) << "elements of this number are about 0.05 wide";
  }
  EXPECT_GT(clusters, 200u);
  EXPECT_GT(cluster_area, 1.9);  // both sides of the unit square, but for a few loners
  for (std::uint32_t r = 0; r < seen.size(); ++r) EXPECT_EQ(seen[r], mesh.roots()[r].divisions == 0 ? 1 : 0);
}

TEST(Subdivision, PointsOfAClusterAreUniformInAreaAndFindIt) {
  const Scene scene(fine_floor(60));
  const ElementMesh mesh = divide_surfaces(scene, 1500);
  std::uint32_t cluster = 0;
  while (!mesh.is_cluster(cluster) || mesh.root(cluster).side != front || mesh.patch_count(cluster) < 5)
    ++cluster;
  const std::size_t parts = mesh.patch_count(cluster);
  constexpr std::uint32_t samples = 20000;
  std::vector<double> count(parts, 0.0);
  int strays = 0;  // points so near a border that rounding takes them over it
  for (std::uint32_t k = 0; k < samples; ++k) {
    const ElementPoint point = mesh.sample(cluster, Sampler(1, 2, k).next_2d());
    const Ray ray{V3f(point.position + point.normal * 1e-3), V3f(-point.normal)};
    const SurfacePoint seen = scene.surface_point(ray, scene.caster().intersect(ray));
    if (mesh.find(seen) != cluster) ++strays;
    for (std::size_t m = 0; m < parts; ++m)
      if (mesh.roots()[mesh.members(cluster)[m]].primitive == seen.primitive) ++count[m];
  }
  EXPECT_LT(strays, 20);
  for (std::size_t m = 0; m < parts; ++m)
    EXPECT_NEAR(count[m] / samples, mesh.patch(cluster, m).area / mesh.whole_area(cluster), 0.01);
}

TEST(Subdivision, TheTwoSidesAndSheetsOfAThinWallStayApart) {
  const Scene scene(fine_floor(100));
  const ElementMesh mesh = divide_surfaces(scene, 500);
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    for (std::size_t k = 0; k < mesh.patch_count(i); ++k)
      EXPECT_GT(mesh.patch(i, k).normal.dot(mesh.patch(i, 0).normal), 0.5);
}

TEST(Subdivision, AnEmptySceneAndOneOfNoAreaHaveNothingToDivide) {
  EXPECT_EQ(divide_surfaces(Scene(SceneDescription{}), 100).count(), 0u);
  SceneDescription scene;
  Mesh mesh;
  mesh.positions = {V3f(0.0f), V3f(1.0f), V3f(2.0f)};
  mesh.triangles = {{0, 1, 2}};
  test::add_diffuse(scene, "flat", mesh, C3f(0.5f));
  EXPECT_EQ(divide_surfaces(Scene(std::move(scene)), 100).count(), 1u);
}

}  // namespace
}  // namespace twopass
