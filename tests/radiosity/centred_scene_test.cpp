#include "radiosity/centred_scene.h"

#include <gtest/gtest.h>

#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

SceneDescription moved(SceneDescription scene, const V3f& offset, float scale) {
  for (Shape& shape : scene.shapes) {
    if (auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
      for (V3f& p : mesh->positions) p = p * scale + offset;
    } else {
      Sphere& sphere = std::get<Sphere>(shape.geometry);
      sphere.center = sphere.center * scale + offset;
      sphere.radius *= scale;
    }
  }
  return scene;
}

void expect_same(const SceneDescription& a, const SceneDescription& b) {
  for (std::size_t s = 0; s < a.shapes.size(); ++s)
    EXPECT_EQ(std::get<Mesh>(a.shapes[s].geometry).positions, std::get<Mesh>(b.shapes[s].geometry).positions);
}

TEST(CentredScene, ComesBackFromFarAwayAndFromAnySize) {
  const SceneDescription room = test::lit_cube(0.5f);
  for (const float scale : {0x1p-90f, 0x1p-20f, 1.0f, 0x1p20f}) {
    const CentredScene back = centred(moved(room, V3f(8192, -4096, 16384) * scale, scale));
    EXPECT_EQ(back.length_unit, double(scale));
    // The negative coordinate leaves the cube on the other side of its plane of symmetry.
    const V3f y_offset(0, -1, 0);
    expect_same(moved(back.scene, -y_offset, 1.0f), room);
  }
}

TEST(CentredScene, LeavesAloneWhatWouldLoseDigits) {
  const SceneDescription around_origin = moved(test::lit_cube(0.5f), V3f(-0.25f, 0.0f, 0.75f), 1.0f);
  expect_same(centred(around_origin).scene, around_origin);
  EXPECT_TRUE(centred({}).scene.shapes.empty());
}

TEST(CentredScene, MovesSpheresToo) {
  const CentredScene back = centred(moved(test::concentric_spheres(0.5f), V3f(4096.0f), 1.0f));
  const Sphere& inner = std::get<Sphere>(back.scene.shapes[0].geometry);
  EXPECT_EQ(double(inner.radius) * back.length_unit, 0.5);
  EXPECT_EQ(inner.center, std::get<Sphere>(back.scene.shapes[1].geometry).center);
  EXPECT_LE(max_abs_component(inner.center), 2.0f);
}

}  // namespace
}  // namespace twopass
