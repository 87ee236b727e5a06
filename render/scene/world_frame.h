// What the coordinates of a scene stand for, where they are not those of its file.
#pragma once

#include "render/core/types.h"
#include "render/scene/camera.h"

namespace twopass {

/// A scene's point p stands at `origin` + `unit` p in the world, that is in the scene's file. A power of two as
/// unit, so that going back and forth changes no digit.
struct WorldFrame {
  V3d origin{0.0, 0.0, 0.0};
  double unit = 1.0;  ///< a length of 1 is this long in the world

  [[nodiscard]] V3d to_world(const V3d& p) const { return origin + p * unit; }
  [[nodiscard]] V3f to_world(const V3f& p) const { return V3f(to_world(V3d(p))); }
  /// The same camera, described in the world's coordinates.
  [[nodiscard]] CameraDescription to_world(const CameraDescription& camera) const;
  /// A camera that is described in the world's coordinates.
  [[nodiscard]] CameraDescription from_world(const CameraDescription& camera) const;
};

}  // namespace twopass
