#include "radiosity/local_albedo.h"

#include <gtest/gtest.h>

#include "radiosity/subdivision.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

// A unit square whose albedo is .8 for u < 1/2 and .2 beyond.
SceneDescription two_halves() {
  SceneDescription scene;
  Mesh mesh = test::quad(V3f(0.0f), V3f(1, 0, 0), V3f(0, 1, 0));
  mesh.uvs = {V2f(0, 0), V2f(1, 0), V2f(1, 1), V2f(0, 1)};
  Checkerboard halves{C3f(0.8f), C3f(0.2f)};
  halves.to_uv = {1.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.25f};
  TexturedModel model{Diffuse{}, {{0, halves}}};
  scene.materials = {
      one_sided("halves", MaterialSide(std::make_shared<const MaterialNode>(MaterialNode{std::move(model)})))};
  scene.shapes = {{"square", std::move(mesh), 0, {}}};
  return scene;
}

TEST(LocalAlbedo, IsThatOfTheElementNotOfTheSurface) {
  const Scene scene(two_halves());
  const ElementMesh mesh = divide_surfaces(scene, 2 * 16 * 16);
  ASSERT_GT(mesh.count(), 200u);
  double area = 0.0, sum = 0.0;
  int pure = 0;
  for (std::uint32_t e = 0; e < mesh.count(); ++e) {
    const Patch patch = mesh.patch(e);
    const auto on_left = std::count_if(patch.corner.begin(), patch.corner.end(),
                                       [](const V3d& corner) { return corner.x <= 0.5; });
    const auto on_right = std::count_if(patch.corner.begin(), patch.corner.end(),
                                        [](const V3d& corner) { return corner.x >= 0.5; });
    if (on_left == 3 || on_right == 3) {
      EXPECT_NEAR(mesh.reflectance(e).x, on_left == 3 ? 0.8f : 0.2f, 1e-5f);
      ++pure;
    }
    area += patch.area;
    sum += patch.area * static_cast<double>(mesh.reflectance(e).x);
  }
  EXPECT_GT(pure, 200);
  EXPECT_NEAR(sum / area, 0.5, 1e-3);
}

// The parts of split elements have albedos of their own, and so has a mesh that is saved and restored.
TEST(LocalAlbedo, FollowsSplittingAndSaving) {
  const Scene scene(two_halves());
  const ElementMesh coarse = divide_surfaces(scene, 2);
  ASSERT_EQ(coarse.count(), 2u);
  EXPECT_NEAR(coarse.reflectance(0).x + coarse.reflectance(1).x, 1.0f, 0.1f);
  const ElementMesh fine = coarse.split({true, true});
  float lowest = 1.0f, highest = 0.0f;
  for (std::uint32_t e = 0; e < fine.count(); ++e) {
    lowest = std::min(lowest, fine.reflectance(e).x);
    highest = std::max(highest, fine.reflectance(e).x);
  }
  EXPECT_NEAR(lowest, 0.2f, 1e-5f);
  EXPECT_NEAR(highest, 0.8f, 1e-5f);
  const auto restored = ElementMesh::restore(scene.shapes(), scene.description().materials, fine.save());
  ASSERT_TRUE(restored);
  for (std::uint32_t e = 0; e < fine.count(); ++e) EXPECT_EQ(restored->reflectance(e), fine.reflectance(e));
}

}  // namespace
}  // namespace twopass
