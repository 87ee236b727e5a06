#include "render/scene/room_view.h"

#include <gtest/gtest.h>

#include "render/scene/geometry.h"
#include "render/scene/scene.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

V3f eye_of(const RoomView& view) {
  const M44d& m = view.camera.to_world;
  return V3f(V3d(m[3][0], m[3][1], m[3][2]));
}
V3f forward_of(const RoomView& view) {
  const M44d& m = view.camera.to_world;
  return V3f(V3d(m[2][0], m[2][1], m[2][2]));
}
bool is_inside(const V3f& p, const V3f& low, const V3f& high) {
  return p.x > low.x && p.y > low.y && p.z > low.z && p.x < high.x && p.y < high.y && p.z < high.z;
}

// A box that shows its front inside, without its walls number `missing`.
SceneDescription room(const V3f& size, int missing = -1) {
  const V3f x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z), o(0, 0, 0);
  SceneDescription scene;
  const Mesh walls[] = {test::quad(o, z, x), test::quad(y, x, z), test::quad(o, y, z),
                        test::quad(x, z, y), test::quad(o, x, y), test::quad(z, y, x)};
  for (int i = 0; i < 6; ++i)
    if (i != missing) test::add_diffuse(scene, "wall", walls[i], C3f(0.5f));
  return scene;
}

TEST(RoomView, AClosedRoomIsSeenFromInsideUnderALamp) {
  const V3f size(8, 3, 5);
  SceneDescription scene = room(size);
  const std::optional<RoomView> view = find_room_view(scene.shapes);
  ASSERT_TRUE(view);
  const V3f eye = eye_of(*view), middle = size * 0.5f;
  EXPECT_TRUE(is_inside(eye, V3f(0.0f), size));
  EXPECT_GT((eye - middle).length(), 3.0f) << "in a corner";
  EXPECT_GT(forward_of(*view).dot((middle - eye).normalized()), 0.9f);
  // The lamp hangs below the ceiling, shines down and is met by rays from below.
  const Mesh& lamp = view->lamp;
  for (const V3f& corner : lamp.positions) {
    EXPECT_TRUE(is_inside(corner, V3f(0.0f), size));
    EXPECT_GT(corner.y, 2.0f);
  }
  float lamp_area = 0.0f;
  for (std::uint32_t t = 0; t < 2; ++t) {
    const auto p = corners(lamp, t);
    const V3f normal = (p[1] - p[0]).cross(p[2] - p[0]);
    EXPECT_LT(normal.y, 0.0f);
    lamp_area += 0.5f * normal.length();
  }
  // Its power, evenly on all walls, and again half of what arrives, and so on: a mean radiance of 0.3.
  const float area = 2.0f * (8 * 3 + 3 * 5 + 5 * 8), power = pi_f * view->radiance * lamp_area;
  EXPECT_NEAR(power / (0.5f * area) * 0.5f / pi_f, 0.3f, 1e-3f);
}

TEST(RoomView, ObjectsAndOpenBoxesAreNone) {
  SceneDescription box;
  test::add_box(box, "box", {0, 0, 0}, {1, 2, 3}, one_sided("grey", Diffuse{C3f(0.5f)}));
  EXPECT_FALSE(find_room_view(box.shapes)) << "its fronts are outside";
  for (int missing = 0; missing < 6; ++missing)
    EXPECT_FALSE(find_room_view(room({3, 3, 3}, missing).shapes)) << "without wall " << missing;
  EXPECT_FALSE(find_room_view({}));
  SceneDescription sphere;
  test::add_diffuse(sphere, "ball", Sphere{}, C3f(0.5f));
  EXPECT_FALSE(find_room_view(sphere.shapes));
}

TEST(RoomView, AnalyticRoomsToo) {
  SceneDescription scene;
  test::add_diffuse(scene, "dome", Sphere{.radius = 4.0f, .inward = true}, C3f(0.5f));
  const std::optional<RoomView> view = find_room_view(scene.shapes);
  ASSERT_TRUE(view);
  EXPECT_LT(eye_of(*view).length(), 4.0f);
  EXPECT_LT(view->lamp.positions[0].length(), 4.0f);
}

TEST(RoomView, FurnitureIsNotStoodIn) {
  SceneDescription scene = room({10, 3, 10});
  // A cupboard in all places but one corner of the room.
  test::add_box(scene, "cupboard", {0.01f, 0.01f, 0.01f}, {9.9f, 2.9f, 6.0f},
                one_sided("wood", Diffuse{C3f(0.5f)}));
  const std::optional<RoomView> view = find_room_view(scene.shapes);
  ASSERT_TRUE(view);
  EXPECT_GT(eye_of(*view).z, 6.0f);
  EXPECT_GT(view->lamp.positions[0].z, 6.0f);
}

}  // namespace
}  // namespace twopass
