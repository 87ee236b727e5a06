#include "radiosity/subdivision.h"

#include <gtest/gtest.h>

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
        const bool comparable = a.divisions > 8 && b.divisions >= a.divisions;
        EXPECT_EQ(comparable ? b.divisions % a.divisions : 0, 0) << most;
      }
  }
}

TEST(Subdivision, EveryTriangleKeepsOneElementWhateverTheBudget) {
  const ElementMesh mesh = divide_surfaces(Scene(test::lit_room()), 3);
  EXPECT_EQ(mesh.count(), 2u * (6 + 10));
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
