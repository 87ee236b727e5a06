#include "render/scene/camera.h"

#include "render/core/error.h"

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

CameraDescription framing_camera(const Box3f& bounds) {
  CameraDescription camera;
  camera.fov_degrees = 39.3;
  camera.fov_axis = FovAxis::smaller;
  if (bounds.isEmpty()) {
    camera.to_world = look_at({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, "camera");
    return camera;
  }
  const V3d center((V3d(bounds.min) + V3d(bounds.max)) * 0.5), half((V3d(bounds.max) - V3d(bounds.min)) * 0.5);
  double extent = std::max(half.x, half.y);
  // Straight on, into a box that is open in front; from above onto something flat.
  const bool flat = half.y < 0.2 * std::max(half.x, half.z);
  if (flat) extent = half.length();
  if (!(extent > 0.0)) extent = half.z > 0.0 ? half.z : 1.0;
  const double distance = 1.05 * extent / std::tan(0.5 * camera.fov_degrees * pi / 180.0);
  const V3d origin =
      flat ? center + V3d(0.0, 0.6, 0.8) * (distance + extent) : center + V3d(0.0, 0.0, half.z + distance);
  camera.to_world = look_at(origin, center, {0, 1, 0}, "camera");
  return camera;
}

Camera::Camera(const CameraDescription& description, int width, int height) {
  const double w = width, h = height;
  double measured = w;  // the extent, in pixels, that the field of view covers
  switch (description.fov_axis) {
    case FovAxis::x:
      break;
    case FovAxis::y:
      measured = h;
      break;
    case FovAxis::diagonal:
      measured = std::hypot(w, h);
      break;
    case FovAxis::smaller:
      measured = std::min(w, h);
      break;
    case FovAxis::larger:
      measured = std::max(w, h);
      break;
  }
  const double pixel = 2.0 * std::tan(0.5 * description.fov_degrees * pi / 180.0) / measured;
  const auto row = [&](int i) {
    return V3d(description.to_world[i][0], description.to_world[i][1], description.to_world[i][2]);
  };
  // Camera space has +x to the left and +y up; pixels run right and down.
  const V3d dx = row(0) * -pixel, dy = row(1) * -pixel;
  origin_ = V3f(row(3));
  dx_ = V3f(dx);
  dy_ = V3f(dy);
  corner_ = V3f(row(2) - dx * (0.5 * w) - dy * (0.5 * h));
}

Ray Camera::ray(const V2f& pixel) const { return {origin_, unit(corner_ + dx_ * pixel.x + dy_ * pixel.y)}; }

}  // namespace twopass
