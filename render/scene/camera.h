// Cameras: pixels to rays, in Mitsuba's conventions. Perspective through a pinhole or a thin lens, or
// orthographic.
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

enum class Projection {
  perspective,
  orthographic  ///< parallel rays along +z; the picture's width is [-1, 1] in camera space
};

/// Where the camera stands and how wide it sees, whatever the size of the picture.
/// Camera space: +z forward, +y up, +x to the LEFT of the picture (Mitsuba's right-handed frame).
struct CameraDescription {
  /// Row vectors (Imath): p_world = p_camera * to_world. A rotation, a translation, perhaps a flip;
  /// orthographic cameras may also be scaled, which is their field of view.
  M44d to_world;
  double fov_degrees = 45.0;  ///< in (0, 180); of perspective cameras, as the next four
  FovAxis fov_axis = FovAxis::x;
  /// What the picture shows lies this share of its size further left and up.
  V2d principal_point_offset{0.0, 0.0};
  double aperture_radius = 0.0;  ///< of the lens, in scene units; 0: a pinhole
  double focus_distance = 1.0;   ///< depth at which a lens is sharp, > 0
  Projection projection = Projection::perspective;
  double near_clip = 0.0;  ///< depths between which there is something to be seen, 0 <= near < far
  double far_clip = infinity_f;
};

/// The matrix of a camera at `origin` looking at `target`. Throws Error at `where` when the points coincide or
/// `up` is parallel to the view.
M44d look_at(const V3d& origin, const V3d& target, const V3d& up, std::string_view where);

enum class FramingView {
  three_quarter,  ///< from above, in front (+z) and to the right (+x): for objects
  front           ///< straight on, into a box that is open in front
};

/// A perspective camera that sees the whole of `bounds` in a picture of any proportions, up +y.
CameraDescription framing_camera(const Box3f& bounds, FramingView view = FramingView::three_quarter);

/// OpenEXR's worldToCamera, for row vectors: x to the right of the picture, y up, z forward; left-handed, of
/// the scale of the world.
M44d world_to_camera(const CameraDescription& camera);
/// OpenEXR's worldToNDC, for row vectors, to be divided by w: (0, 0) is the upper left corner of a picture of
/// this size, (1, 1) its lower right one.
M44d world_to_ndc(const CameraDescription& camera, int width, int height);

/// What a camera sees of the scene at one point of the picture.
struct CameraRay {
  Ray ray;      ///< from the near clipping plane on; direction of unit length
  float reach;  ///< distance along the ray to the far clipping plane
};

/// A camera for a picture of a given size.
class Camera {
 public:
  Camera(const CameraDescription& description, int width, int height);
  /// The size of the picture, in pixels.
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Whether rays start on a lens: then `ray` needs two random numbers more.
  [[nodiscard]] bool has_lens() const { return aperture_radius_ > 0.0f; }

  /// The ray through the point `pixel` of the picture: (0, 0) is its upper left corner, (width, height) the
  /// lower right. `lens` in [0,1)^2 chooses the point of the lens, uniformly; other cameras do not look at it.
  [[nodiscard]] CameraRay ray(const V2f& pixel, const V2f& lens = {0.0f, 0.0f}) const;

 private:
  int width_, height_;
  bool is_perspective_;
  float aperture_radius_, focus_distance_, near_clip_, clip_range_;
  V3f lens_x_, lens_y_;  // half axes of the lens
  // Perspective: the ray through pixel (x, y) is origin_ + t (corner_ + x dx_ + y dy_), at depth t.
  // Orthographic: it starts at corner_ + x dx_ + y dy_ and has the direction forward_.
  V3f origin_, corner_, dx_, dy_, forward_;
};

}  // namespace twopass
