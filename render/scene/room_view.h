// Closed rooms that bring neither a camera nor a light: from where to look, and a lamp. (Objects are framed
// from outside: camera.h.)
#pragma once

#include <optional>
#include <span>

#include "render/scene/camera.h"
#include "render/scene/shape.h"

namespace twopass {

/// How to show a room.
struct RoomView {
  CameraDescription camera;  ///< inside of it, at eye height, up +y: where the view to the middle is deepest
  Mesh lamp;                 ///< a rectangle below the ceiling, in front of the camera; its front is below
  float radiance = 0.0f;     ///< of the lamp, W/(m2 sr): walls of albedo 1/2 have a mean radiance of about 0.3
};

/// The view of a room, or nothing where the shapes are none: where places at eye height are closed in on all
/// sides (at most 1 of 64 rays escapes) by surfaces that mostly show their fronts, while from outside mostly
/// their backs are seen. O(n log n) for n triangles: it casts some ten thousand rays.
std::optional<RoomView> find_room_view(std::span<const Shape> shapes);

}  // namespace twopass
