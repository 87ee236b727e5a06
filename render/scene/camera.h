// The perspective camera: pixels to rays, in Mitsuba's conventions.
#pragma once

#include <optional>
#include <string_view>

#include "render/core/names.h"
#include "render/core/types.h"
#include "render/scene/ray.h"

namespace twopass {

/// The extent of the picture that the field of view measures.
enum class FovAxis { x, y, diagonal, smaller, larger };

inline constexpr Named<FovAxis> fov_axis_names[] = {
    {"x", FovAxis::x},
    {"y", FovAxis::y},
    {"diagonal", FovAxis::diagonal},
    {"smaller", FovAxis::smaller},
    {"larger", FovAxis::larger},
};

/// Where the camera stands and how wide it sees, whatever the size of the picture.
/// Camera space: +z forward, +y up, +x to the LEFT of the picture (Mitsuba's right-handed frame).
struct CameraDescription {
  M44d to_world;  ///< row vectors (Imath): p_world = p_camera * to_world; a rotation, a translation, perhaps a
                  ///< flip
  double fov_degrees = 45.0;  ///< in (0, 180)
  FovAxis fov_axis = FovAxis::x;
};

/// The matrix of a camera at `origin` looking at `target`. Throws Error at `where` when the points coincide or
/// `up` is parallel to the view.
M44d look_at(const V3d& origin, const V3d& target, const V3d& up, std::string_view where);

/// A camera that sees the whole of `bounds`, from slightly above its front (+z), up +y.
CameraDescription framing_camera(const Box3f& bounds);

/// A camera for a picture of a given size.
class Camera {
 public:
  Camera(const CameraDescription& description, int width, int height);
  /// The ray through the point `pixel` of the picture: (0, 0) is its upper left corner, (width, height) the
  /// lower right. The direction has unit length.
  [[nodiscard]] Ray ray(const V2f& pixel) const;

 private:
  V3f origin_, corner_, dx_, dy_;  // direction through pixel (x, y) is corner_ + x dx_ + y dy_
};

}  // namespace twopass
