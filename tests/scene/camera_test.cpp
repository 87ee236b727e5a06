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
  const Ray ray = camera.ray({32, 24}).ray;
  EXPECT_NEAR((ray.direction - V3f(0, 0, 1)).length(), 0.0f, 1e-6f);
  EXPECT_EQ(camera.ray({0, 0}).ray.origin, V3f(1, 2, 3));
}

// Mitsuba's handedness: looking along +z with +y up, +x is on the LEFT of the picture.
TEST(Camera, XIsLeftAndYIsUp) {
  const Camera camera(looking_along_z(50, FovAxis::x), 64, 48);
  EXPECT_GT(camera.ray({0, 24}).ray.direction.x, 0.1f);
  EXPECT_LT(camera.ray({64, 24}).ray.direction.x, -0.1f);
  EXPECT_GT(camera.ray({32, 0}).ray.direction.y, 0.1f);
  EXPECT_LT(camera.ray({32, 48}).ray.direction.y, -0.1f);
}

TEST(Camera, FieldOfViewIsMeasuredAlongItsAxis) {
  const V2f left(0, 24), right(64, 24), top(32, 0), bottom(32, 48), corner(0, 0), opposite(64, 48);
  const auto angle = [&](FovAxis axis, const V2f& a, const V2f& b) {
    const Camera camera(looking_along_z(50, axis), 64, 48);
    return degrees_between(camera.ray(a).ray.direction, camera.ray(b).ray.direction);
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

// A shift by a tenth of the width: what was at the pixel x + w/10 is at x.
TEST(Camera, PrincipalPointShiftsThePicture) {
  CameraDescription description = looking_along_z(50, FovAxis::y);
  const Camera straight(description, 64, 48);
  description.principal_point_offset = {0.25, -0.5};
  const Camera shifted(description, 64, 48);
  for (const V2f& pixel : {V2f(0, 0), V2f(31.5f, 7.25f), V2f(64, 48)})
    EXPECT_NEAR((shifted.ray(pixel).ray.direction - straight.ray(pixel + V2f(16, -24)).ray.direction).length(),
                0.0f, 1e-6f);
}

// Clipping planes are given by depth, so that they are planes.
TEST(Camera, RaysRunFromTheNearToTheFarPlane) {
  CameraDescription description = looking_along_z(80, FovAxis::x);
  description.near_clip = 0.5;
  description.far_clip = 7.0;
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const double aperture : {0.0, 0.3}) {
      description.projection = projection;
      description.aperture_radius = aperture;
      description.focus_distance = 2.0;
      const Camera camera(description, 64, 48);
      for (const V2f& pixel : {V2f(0, 0), V2f(31.5f, 7.25f), V2f(64, 48)}) {
        const CameraRay seen = camera.ray(pixel, {0.7f, 0.3f});
        EXPECT_NEAR(seen.ray.direction.length(), 1.0f, 1e-6f);
        EXPECT_NEAR(seen.ray.origin.z, 3.5f, 1e-5f);
        EXPECT_NEAR((seen.ray.origin + seen.ray.direction * seen.reach).z, 10.0f, 1e-5f);
      }
    }
  EXPECT_EQ(Camera(looking_along_z(80, FovAxis::x), 8, 8).ray({1, 2}).reach, infinity_f);
}

// The definition of a thin lens: rays from all of it through one point of the picture meet in the plane of
// focus, where the pinhole's ray arrives; their origins fill the disc uniformly.
TEST(Camera, RaysOfALensMeetInThePlaneOfFocus) {
  CameraDescription description = looking_along_z(60, FovAxis::x);
  const Camera pinhole(description, 64, 48);
  EXPECT_FALSE(pinhole.has_lens());
  description.aperture_radius = 0.25;
  description.focus_distance = 4.0;
  const Camera camera(description, 64, 48);
  ASSERT_TRUE(camera.has_lens());
  const auto at_depth = [](const Ray& ray, float depth) {
    return ray.origin + ray.direction * ((3.0f + depth - ray.origin.z) / ray.direction.z);
  };
  constexpr int steps = 32;
  double moment = 0.0;
  V3d mean(0.0, 0.0, 0.0);
  for (const V2f& pixel : {V2f(5.5f, 40.25f), V2f(32, 24)}) {
    const V3f focus = at_depth(pinhole.ray(pixel).ray, 4.0f);
    for (int i = 0; i < steps; ++i)
      for (int j = 0; j < steps; ++j) {
        const Ray ray = camera.ray(pixel, {(i + 0.5f) / steps, (j + 0.5f) / steps}).ray;
        EXPECT_NEAR((at_depth(ray, 4.0f) - focus).length(), 0.0f, 1e-5f);
        const V3d from(ray.origin - V3f(1, 2, 3));
        EXPECT_LE(from.length(), 0.25 * 1.000001);
        EXPECT_EQ(from.z, 0.0);
        moment += from.dot(from);
        mean += from;
      }
  }
  // A uniform disc of radius r: mean 0, mean square distance r^2 / 2.
  EXPECT_NEAR(moment / (2 * steps * steps), 0.25 * 0.25 / 2.0, 1e-6);
  EXPECT_NEAR(mean.length() / (2 * steps * steps), 0.0, 1e-6);
}

TEST(Camera, OrthographicRaysAreParallelAndFillTheSquare) {
  CameraDescription description;
  description.projection = Projection::orthographic;
  M44d scale;
  scale.setScale(V3d(3.0, 3.0, 1.0));
  description.to_world = scale * look_at({1, 2, 3}, {1, 2, 4}, {0, 1, 0}, "test");
  const Camera camera(description, 64, 48);
  EXPECT_FALSE(camera.has_lens());
  const auto corner = [&](float x, float y) { return camera.ray({x, y}).ray; };
  EXPECT_NEAR((corner(0, 0).origin - V3f(4, 2 + 3 * 0.75f, 3)).length(), 0.0f, 1e-5f) << "x is left, y is up";
  EXPECT_NEAR((corner(64, 48).origin - V3f(-2, 2 - 3 * 0.75f, 3)).length(), 0.0f, 1e-5f);
  EXPECT_EQ(corner(7, 9).direction, V3f(0, 0, 1));
}

TEST(Camera, FramingCameraSeesAllCorners) {
  for (const FramingView view : {FramingView::three_quarter, FramingView::front})
    for (const V3f& size : {V3f(2, 2, 2), V3f(1e-3f, 5e-3f, 1e-3f), V3f(100, 0, 100), V3f(1, 0, 0),
                            V3f(300, 200, 1), V3f(0, 0, 0)}) {
      const Box3f box(V3f(5, 6, 7), V3f(5, 6, 7) + size);
      const CameraDescription description = framing_camera(box, view);
      const M44d to_camera = description.to_world.inverse();
      const double half = std::tan(0.5 * description.fov_degrees * pi / 180.0);
      double largest = 0.0;
      for (int k = 0; k < 8; ++k) {
        const V3d corner(k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y,
                         k & 4 ? box.max.z : box.min.z);
        V3d p;
        to_camera.multVecMatrix(corner, p);
        EXPECT_GT(p.z, 0.0);
        largest = std::max({largest, std::abs(p.x) / (half * p.z), std::abs(p.y) / (half * p.z)});
      }
      EXPECT_LE(largest, 1.0001);
      if (size.length() > 0.0f) {
        EXPECT_GE(largest, 0.85) << "as near as that allows";
      }
    }
  EXPECT_NO_THROW(framing_camera(Box3f()));
}

// Points along camera rays are where OpenEXR's matrices say: for row vectors, y down in NDC, left-handed in the
// camera.
TEST(Camera, MatricesOfOpenExrProjectPointsToTheirPixels) {
  CameraDescription shifted = looking_along_z(50, FovAxis::y);
  shifted.to_world = look_at({1, 2, 3}, {4, -1, 2}, {0.2, 1, 0.1}, "test");
  shifted.principal_point_offset = {0.1, -0.2};
  CameraDescription clipped = shifted;
  clipped.near_clip = 0.5;
  clipped.far_clip = 50.0;
  CameraDescription parallel = clipped;
  parallel.projection = Projection::orthographic;
  for (int k = 0; k < 3; ++k) {
    parallel.to_world[0][k] *= 3.0;
    parallel.to_world[1][k] *= 3.0;
  }
  for (const CameraDescription& description : {shifted, clipped, parallel}) {
    constexpr int width = 64, height = 48;
    const Camera camera(description, width, height);
    const M44d to_camera = world_to_camera(description), to_ndc = world_to_ndc(description, width, height);
    for (const V2f& pixel : {V2f(0, 0), V2f(64, 48), V2f(10, 30), V2f(-5, 60)})
      for (const float distance : {1.0f, 7.0f}) {
        const Ray ray = camera.ray(pixel).ray;
        V3d ndc, at;
        const V3d point(ray.origin + ray.direction * distance);
        to_ndc.multVecMatrix(point, ndc);
        EXPECT_NEAR(ndc.x, pixel.x / width, 1e-5);
        EXPECT_NEAR(ndc.y, pixel.y / height, 1e-5);
        to_camera.multVecMatrix(point, at);
        EXPECT_GT(at.z, 0.0);
        // To the right of the axis is x > 0, above it y > 0.
        EXPECT_TRUE(pixel != V2f(64, 48) || (at.x > 0.0 && at.y < 0.0));
      }
    V3d origin;
    to_camera.multVecMatrix(V3d(1, 2, 3), origin);
    EXPECT_NEAR(origin.length(), 0.0, 1e-12);
    EXPECT_NEAR(to_camera.determinant(), -1.0, 1e-12) << "left-handed, and of the world's scale";
  }
  V3d near, far;
  world_to_ndc(clipped, 64, 48).multVecMatrix(V3d(1, 2, 3) + V3d(3, -3, -1).normalized() * 0.5, near);
  world_to_ndc(clipped, 64, 48).multVecMatrix(V3d(1, 2, 3) + V3d(3, -3, -1).normalized() * 50.0, far);
  EXPECT_NEAR(near.z, 0.0, 1e-9);
  EXPECT_NEAR(far.z, 1.0, 1e-9);
}

}  // namespace
}  // namespace twopass
