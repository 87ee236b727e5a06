#include "render/scene/world_frame.h"

namespace twopass {

namespace {

// Lengths times `factor`, places by `place`.
template <class Place>
CameraDescription moved(CameraDescription camera, double factor, const Place& place) {
  M44d& m = camera.to_world;
  const V3d eye = place(V3d(m[3][0], m[3][1], m[3][2]));
  for (int axis = 0; axis < 3; ++axis) {
    m[3][axis] = eye[axis];
    // The width of what it sees is a length of its axes; so is the depth, in which clipping planes are given.
    if (camera.projection == Projection::orthographic)
      for (int row = 0; row < 2; ++row) m[row][axis] *= factor;
  }
  camera.aperture_radius *= factor;
  camera.focus_distance *= factor;
  camera.near_clip *= factor;
  camera.far_clip *= factor;
  return camera;
}

}  // namespace

CameraDescription WorldFrame::to_world(const CameraDescription& camera) const {
  return moved(camera, unit, [&](const V3d& p) { return to_world(p); });
}

CameraDescription WorldFrame::from_world(const CameraDescription& camera) const {
  return moved(camera, 1.0 / unit, [&](const V3d& p) { return (p - origin) * (1.0 / unit); });
}

}  // namespace twopass
