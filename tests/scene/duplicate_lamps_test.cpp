#include "render/scene/duplicate_lamps.h"

#include <gtest/gtest.h>

#include "tests/support/scenes.h"

namespace twopass {
namespace {

const V3f o(0.0f), x(1, 0, 0), y(0, 1, 0);

Shape& add_lamp(SceneDescription& scene, const Mesh& mesh, bool front_shines = true, bool back_shines = false) {
  Shape& shape = test::add_diffuse(scene, "lamp", mesh, C3f(0.5f));
  shape.radiance = {C3f(front_shines ? 1.0f : 0.0f), C3f(back_shines ? 1.0f : 0.0f)};
  return shape;
}

std::size_t triangles(const SceneDescription& scene, std::size_t shape) {
  return std::get<Mesh>(scene.shapes[shape].geometry).triangles.size();
}

TEST(DuplicateLamps, AreLeftOutHoweverTheyAreWritten) {
  SceneDescription scene;
  add_lamp(scene, test::quad(o, x, y));
  Mesh turned = test::quad(o, x, y), moved = turned;
  for (V3u& t : turned.triangles) t = {t.y, t.z, t.x};
  turned.attributes = {{"face_color", {C3f(0.25f), C3f(0.75f)}}};
  turned.positions[0].x = -0.0f;
  moved.positions[2].x = 1.5f;  // both of its triangles change
  add_lamp(scene, turned);
  add_lamp(scene, moved);
  test::add_diffuse(scene, "no lamp", test::quad(o, x, y), C3f(0.5f));
  EXPECT_EQ(leave_out_duplicate_lamps(scene), 2u);
  EXPECT_EQ(triangles(scene, 0), 2u);
  EXPECT_EQ(triangles(scene, 1), 0u);
  EXPECT_TRUE(std::get<Mesh>(scene.shapes[1].geometry).attributes[0].values.empty());
  EXPECT_EQ(triangles(scene, 2), 2u);
  EXPECT_EQ(triangles(scene, 3), 2u);
  EXPECT_EQ(leave_out_duplicate_lamps(scene), 0u);
}

// A lamp and its inside-out copy shine to both sides: neither is too much. A third one is.
TEST(DuplicateLamps, OfOtherSidesStay) {
  SceneDescription scene;
  add_lamp(scene, test::quad(o, x, y));
  add_lamp(scene, test::quad(o, y, x));
  EXPECT_EQ(leave_out_duplicate_lamps(scene), 0u);
  add_lamp(scene, test::quad(o, y, x), true, true);
  add_lamp(scene, test::quad(o, x, y), false, true);
  Mesh triangle;
  triangle.positions = {o, x, x + y};
  triangle.triangles = {{0, 1, 2}};
  add_lamp(scene, triangle);
  EXPECT_EQ(leave_out_duplicate_lamps(scene), 5u);
  EXPECT_EQ(triangles(scene, 2), 0u);
  EXPECT_EQ(triangles(scene, 3), 0u);
  EXPECT_EQ(triangles(scene, 4), 0u);
}

}  // namespace
}  // namespace twopass
