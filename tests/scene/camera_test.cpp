#include "render/scene/camera.h"

#include <gtest/gtest.h>

#include "render/core/error.h"

namespace twopass {
namespace {

CameraDescription looking_along_z(double fov_degrees, FovAxis axis) {
  CameraDescription camera;
  camera.to_world = look_at({1, 2, 3}, {1, 2, 4}, {0, 1, 0}, "test");
  camera.fov_degrees = fov_degrees;
  camera.fov_axis = axis;
  return camera;
}

double degrees_between(const V3f& a, const V3f& b) {
  return std::atan2(a.cross(b).length(), a.dot(b)) * 180.0 / pi;
}

TEST(Camera, CentreLooksForwardAndEveryRayStartsAtTheOrigin) {
  const Camera camera(looking_along_z(50, FovAxis::x), 64, 48);
  const Ray ray = camera.ray({32, 24});
  EXPECT_NEAR((ray.direction - V3f(0, 0, 1)).length(), 0.0f, 1e-6f);
  EXPECT_EQ(camera.ray({0, 0}).origin, V3f(1, 2, 3));
}

// Mitsuba's handedness: looking along +z with +y up, +x is on the LEFT of the picture.
TEST(Camera, XIsLeftAndYIsUp) {
  const Camera camera(looking_along_z(50, FovAxis::x), 64, 48);
  EXPECT_GT(camera.ray({0, 24}).direction.x, 0.1f);
  EXPECT_LT(camera.ray({64, 24}).direction.x, -0.1f);
  EXPECT_GT(camera.ray({32, 0}).direction.y, 0.1f);
  EXPECT_LT(camera.ray({32, 48}).direction.y, -0.1f);
}

TEST(Camera, FieldOfViewIsMeasuredAlongItsAxis) {
  const V2f left(0, 24), right(64, 24), top(32, 0), bottom(32, 48), corner(0, 0), opposite(64, 48);
  const auto angle = [&](FovAxis axis, const V2f& a, const V2f& b) {
    const Camera camera(looking_along_z(50, axis), 64, 48);
    return degrees_between(camera.ray(a).direction, camera.ray(b).direction);
  };
  EXPECT_NEAR(angle(FovAxis::x, left, right), 50, 1e-4);
  EXPECT_NEAR(angle(FovAxis::larger, left, right), 50, 1e-4);
  EXPECT_NEAR(angle(FovAxis::y, top, bottom), 50, 1e-4);
  EXPECT_NEAR(angle(FovAxis::smaller, top, bottom), 50, 1e-4);
  EXPECT_NEAR(angle(FovAxis::diagonal, corner, opposite), 50, 1e-4);
}

TEST(Camera, LookAtRefusesWhatHasNoDirection) {
  EXPECT_THROW(look_at({1, 1, 1}, {1, 1, 1}, {0, 1, 0}, "a"), Error);
  EXPECT_THROW(look_at({0, 0, 0}, {0, 2, 0}, {0, 1, 0}, "a"), Error);
  EXPECT_THROW(look_at({0, 0, 0}, {0, 0, 1}, {0, 0, 0}, "a"), Error);
}

TEST(Camera, FramingCameraSeesAllCorners) {
  for (const V3f& size :
       {V3f(2, 2, 2), V3f(1e-3f, 5e-3f, 1e-3f), V3f(100, 0, 100), V3f(1, 0, 0), V3f(300, 200, 1)}) {
    const Box3f box(V3f(5, 6, 7), V3f(5, 6, 7) + size);
    const CameraDescription description = framing_camera(box);
    const M44d to_camera = description.to_world.inverse();
    const double half = std::tan(0.5 * description.fov_degrees * pi / 180.0);
    for (int k = 0; k < 8; ++k) {
      const V3d corner(k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y,
                       k & 4 ? box.max.z : box.min.z);
      V3d p;
      to_camera.multVecMatrix(corner, p);
      EXPECT_GT(p.z, 0.0);
      EXPECT_LE(std::abs(p.x), half * p.z * 1.0001);
      EXPECT_LE(std::abs(p.y), half * p.z * 1.0001);
    }
  }
  EXPECT_NO_THROW(framing_camera(Box3f()));
}

}  // namespace
}  // namespace twopass
