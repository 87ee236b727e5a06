#include "render/scene/camera.h"

#include "render/core/error.h"
#include "render/core/warp.h"

namespace twopass {

M44d look_at(const V3d& origin, const V3d& target, const V3d& up, std::string_view where) {
  V3d forward = target - origin;
  if (!(forward.length() > 0.0))
    throw Error(where, "the camera's origin and target coincide", "move one of them");
  forward /= forward.length();
  V3d left = up.cross(forward);
  if (!(left.length() > 1e-12 * up.length()))
    throw Error(where, "the camera's up vector is parallel to its view or zero", "give another up vector");
  left /= left.length();
  const V3d true_up = forward.cross(left);
  return {left.x,    left.y,    left.z,    0.0, true_up.x, true_up.y, true_up.z, 0.0,
          forward.x, forward.y, forward.z, 0.0, origin.x,  origin.y,  origin.z,  1.0};
}

CameraDescription framing_camera(const Box3f& bounds, FramingView view) {
  CameraDescription camera;
  camera.fov_degrees = 39.3;
  camera.fov_axis = FovAxis::smaller;
  const V3d forward = view == FramingView::front ? V3d(0.0, 0.0, -1.0) : V3d(-0.5, -0.45, -1.0).normalized();
  V3d center(0.0, 0.0, 0.0), half(1.0, 1.0, 1.0);
  if (!bounds.isEmpty()) {
    center = (V3d(bounds.min) + V3d(bounds.max)) * 0.5;
    half = (V3d(bounds.max) - V3d(bounds.min)) * 0.5;
  }
  if (!(half.length() > 0.0)) half = V3d(1.0, 1.0, 1.0);
  // As near as all corners allow: each must have depth * tan(fov / 2) >= its distance from the axis.
  const M44d axes = look_at({0, 0, 0}, forward, {0, 1, 0}, "camera");
  const double slope = std::tan(0.5 * camera.fov_degrees * pi / 180.0);
  double distance = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const V3d p((corner & 1) != 0 ? half.x : -half.x, (corner & 2) != 0 ? half.y : -half.y,
                (corner & 4) != 0 ? half.z : -half.z);
    const auto along = [&](int axis) { return p.dot(V3d(axes[axis][0], axes[axis][1], axes[axis][2])); };
    distance = std::max(distance, std::max(std::abs(along(0)), std::abs(along(1))) / slope - along(2));
  }
  constexpr double margin = 1.05;
  camera.to_world = look_at(center - forward * (margin * distance), center, {0, 1, 0}, "camera");
  return camera;
}

namespace {

// The extent, in pixels, that the field of view covers.
double measured_extent(FovAxis axis, double width, double height) {
  switch (axis) {
    case FovAxis::y:
      return height;
    case FovAxis::diagonal:
      return std::hypot(width, height);
    case FovAxis::smaller:
      return std::min(width, height);
    case FovAxis::larger:
      return std::max(width, height);
    case FovAxis::x:
      break;
  }
  return width;
}

// The side of a pixel: at depth 1 of a perspective camera; of others, in units of its axes.
double pixel_size(const CameraDescription& camera, double width, double height) {
  if (camera.projection == Projection::orthographic) return 2.0 / width;
  return 2.0 * std::tan(0.5 * camera.fov_degrees * pi / 180.0) /
         measured_extent(camera.fov_axis, width, height);
}

V3d axis_of(const CameraDescription& camera, int i) {
  return {camera.to_world[i][0], camera.to_world[i][1], camera.to_world[i][2]};
}

}  // namespace

M44d world_to_camera(const CameraDescription& camera) {
  M44d to_world;
  for (int i = 0; i < 3; ++i) {
    const V3d axis = axis_of(camera, i).normalized() * (i == 0 ? -1.0 : 1.0);
    for (int k = 0; k < 3; ++k) to_world[i][k] = axis[k];
  }
  for (int k = 0; k < 3; ++k) to_world[3][k] = camera.to_world[3][k];
  return to_world.inverse();
}

M44d world_to_ndc(const CameraDescription& camera, int width, int height) {
  const bool is_perspective = camera.projection == Projection::perspective;
  const double pixel = pixel_size(camera, width, height);
  const double w = pixel * width * (is_perspective ? 1.0 : axis_of(camera, 0).length());
  const double h = pixel * height * (is_perspective ? 1.0 : axis_of(camera, 1).length());
  // What is multiplied by the depth, which perspective divides by, and what is not.
  const int shift = is_perspective ? 2 : 3;
  M44d m;
  m[0][0] = 1.0 / w;
  m[1][1] = -1.0 / h;
  m[shift][0] = 0.5 - camera.principal_point_offset.x;
  m[shift][1] = 0.5 - camera.principal_point_offset.y;
  // Depths from the near to the far clipping plane become 0 to 1, where there are such.
  const double near = is_perspective && camera.near_clip == 0.0 ? 1.0 : camera.near_clip;
  const double range = camera.far_clip - near, far = camera.far_clip;
  if (is_perspective) {
    m[2][2] = std::isfinite(range) && range > 0.0 ? far / range : 1.0;
    m[2][3] = 1.0;
    m[3][3] = 0.0;
  } else if (std::isfinite(range) && range > 0.0) {
    m[2][2] = 1.0 / range;
  }
  m[3][2] = -near * m[2][2];
  return world_to_camera(camera) * m;
}

Camera::Camera(const CameraDescription& description, int width, int height)
    : width_(width),
      height_(height),
      is_perspective_(description.projection == Projection::perspective),
      aperture_radius_(is_perspective_ ? static_cast<float>(description.aperture_radius) : 0.0f),
      focus_distance_(static_cast<float>(description.focus_distance)),
      near_clip_(static_cast<float>(description.near_clip)),
      clip_range_(static_cast<float>(description.far_clip - description.near_clip)) {
  const auto row = [&](int i) { return axis_of(description, i); };
  const double w = width, h = height, pixel = pixel_size(description, w, h);
  // Camera space has +x to the left and +y up; pixels run right and down.
  const V3d dx = row(0) * -pixel, dy = row(1) * -pixel;
  const V2d& shift = description.principal_point_offset;
  const V3d corner = dx * ((shift.x - 0.5) * w) + dy * ((shift.y - 0.5) * h);
  dx_ = V3f(dx);
  dy_ = V3f(dy);
  origin_ = V3f(row(3));
  forward_ = V3f(row(2).normalized());
  corner_ = V3f(is_perspective_ ? row(2) + corner : row(3) + row(2) * description.near_clip + corner);
  lens_x_ = V3f(row(0).normalized()) * aperture_radius_;
  lens_y_ = V3f(row(1).normalized()) * aperture_radius_;
}

CameraRay Camera::ray(const V2f& pixel, const V2f& lens) const {
  V3f at = corner_ + dx_ * pixel.x + dy_ * pixel.y;
  if (!is_perspective_) return {{at, forward_}, clip_range_};
  V3f origin = origin_;
  if (has_lens()) {
    // Uniform on the lens; rays from all of it meet where the one through its middle has the depth of focus.
    const V2f point = circle(lens.y) * std::sqrt(lens.x);
    const V3f offset = lens_x_ * point.x + lens_y_ * point.y;
    origin += offset;
    at -= offset / focus_distance_;
  }
  // `at` has the depth 1: its multiples have the depths that clipping planes are given by.
  const float length = at.length();
  return {{origin + at * near_clip_, at * (1.0f / length)}, clip_range_ * length};
}

}  // namespace twopass
