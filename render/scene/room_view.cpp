#include "render/scene/room_view.h"

#include <vector>

#include "render/core/warp.h"
#include "render/scene/ray_caster.h"
#include "render/scene/scene.h"

namespace twopass {
namespace {

constexpr double field_of_view = 70.0;  // degrees, along the longer edge of the picture
constexpr float eye_height = 0.55f;     // over the height of the room
constexpr int grid = 12;                // places along x and z
constexpr int directions = 64;          // to look around
constexpr float mostly = 0.6f;          // of what is seen
// Large, so that little of its light is noise: half its side over the narrow side of the room.
constexpr float lamp_size = 0.2f;
constexpr float mean_radiance = 0.3f;  // of walls of albedo 1/2
constexpr float clearance = 0.02f;     // of the diagonal: nothing may be nearer to the camera

/// What some rays met.
struct Sight {
  int rays = 0, hits = 0, fronts = 0;
  float nearest = infinity_f, depth_sum = 0.0f;
  [[nodiscard]] bool is_mostly_fronts() const {
    return static_cast<float>(fronts) > mostly * static_cast<float>(hits);
  }
};

class Surroundings {
 public:
  explicit Surroundings(std::span<const Shape> shapes)
      : shapes_(shapes), bounds_(bounds_of(shapes)), caster_(shapes) {}

  std::optional<RoomView> find() const {
    const float diagonal = bounds_.size().length();
    if (bounds_.isEmpty() || !(diagonal > 0.0f) || !shows_backs_outside()) return std::nullopt;
    const V3f size = bounds_.size(), middle = bounds_.min + size * V3f(0.5f, 0.4f, 0.5f);
    std::optional<RoomView> best;
    float deepest = 0.0f;
    for (int i = 0; i < grid * grid; ++i) {
      const auto share = [](int k) { return (static_cast<float>(k) + 0.5f) / grid; };
      const V3f eye = bounds_.min + size * V3f(share(i % grid), eye_height, share(i / grid));
      const Sight around = look_around(eye);
      if (around.hits < directions - 1 || !around.is_mostly_fronts() || around.nearest < clearance * diagonal)
        continue;
      const CameraDescription camera = camera_at(eye, middle);
      const Sight view = look(camera);
      if (view.depth_sum <= deepest) continue;
      deepest = view.depth_sum;
      best.emplace().camera = camera;
    }
    if (best) add_lamp(*best);
    return best;
  }

 private:
  void cast(const Ray& ray, Sight& sight) const {
    const Hit hit = caster_.intersect(ray);
    ++sight.rays;
    if (hit.escaped()) return;
    ++sight.hits;
    sight.fronts += shows_front(ray, hit);
    sight.nearest = std::min(sight.nearest, hit.t);
    sight.depth_sum += hit.t;
  }

  [[nodiscard]] bool shows_front(const Ray& ray, const Hit& hit) const {
    const Geometry& geometry = shapes_[hit.shape].geometry;
    if (mesh_of(geometry)) {
      const auto p = corners(geometry, hit.primitive);
      return (p[1] - p[0]).cross(p[2] - p[0]).dot(ray.direction) < 0.0f;
    }
    if (const auto* disk = std::get_if<Disk>(&geometry))
      return (disk->x.cross(disk->y).dot(ray.direction) < 0.0f) != disk->reversed;
    // Of spheres and cylinders one meets the outside unless one is inside.
    const V3f at = ray.origin + ray.direction * hit.t;
    if (const auto* sphere = std::get_if<Sphere>(&geometry))
      return ((at - sphere->center).dot(ray.direction) < 0.0f) != sphere->inward;
    const auto& cylinder = std::get<Cylinder>(geometry);
    const V3f from_base = at - cylinder.base, axis = cylinder.axes[2];
    return ((from_base - axis * from_base.dot(axis)).dot(ray.direction) < 0.0f) != cylinder.inward;
  }

  [[nodiscard]] Sight look_around(const V3f& eye) const {
    Sight sight;
    for (int i = 0; i < directions; ++i) {
      // Evenly on the sphere, along a spiral of the golden angle.
      const float z = 1.0f - (2.0f * static_cast<float>(i) + 1.0f) / directions;
      const float turns = 0.381966f * static_cast<float>(i);
      const V2f side = circle(turns - std::floor(turns)) * std::sqrt(1.0f - z * z);
      cast({eye, V3f(side.x, z, side.y)}, sight);
    }
    return sight;
  }

  [[nodiscard]] Sight look(const CameraDescription& description) const {
    constexpr int width = 12, height = 9;
    const Camera camera(description, width, height);
    Sight sight;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        cast(camera.ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}).ray, sight);
    return sight;
  }

  [[nodiscard]] bool shows_backs_outside() const {
    const Sight sight = look(framing_camera(bounds_));
    return sight.hits > 0 &&
           static_cast<float>(sight.hits - sight.fronts) > mostly * static_cast<float>(sight.hits);
  }

  [[nodiscard]] static CameraDescription camera_at(const V3f& eye, const V3f& middle) {
    CameraDescription camera;
    camera.to_world = look_at(V3d(eye), V3d(middle), {0, 1, 0}, "camera");
    camera.fov_degrees = field_of_view;
    camera.fov_axis = FovAxis::larger;
    return camera;
  }

  /// Half way to what the camera looks at, below what is above that place.
  void add_lamp(RoomView& view) const {
    const auto row = [&](int i) {
      return V3f(static_cast<float>(view.camera.to_world[i][0]), static_cast<float>(view.camera.to_world[i][1]),
                 static_cast<float>(view.camera.to_world[i][2]));
    };
    const Ray forward{row(3), row(2)};
    const Hit ahead = caster_.intersect(forward);
    const float depth = ahead.escaped() ? bounds_.size().length() : ahead.t;
    const V3f below = forward.origin + forward.direction * (0.5f * depth);
    const V3f size = bounds_.size();
    float half = lamp_size * std::min(size.x, size.z), height = bounds_.max.y - below.y;
    // The lowest ceiling above its middle and its corners.
    for (const V2f& place : {V2f(0, 0), V2f(-1, -1), V2f(1, -1), V2f(1, 1), V2f(-1, 1)}) {
      const V3f foot = below + V3f(place.x * half, 0.0f, place.y * half);
      const Hit ceiling = caster_.intersect({foot, {0.0f, 1.0f, 0.0f}});
      if (!ceiling.escaped()) height = std::min(height, ceiling.t);
    }
    half = std::min(half, 0.5f * height);
    const V3f middle = below + V3f(0.0f, 0.95f * height, 0.0f);
    const V3f x(half, 0.0f, 0.0f), z(0.0f, 0.0f, half);
    view.lamp.positions = {middle - x - z, middle + x - z, middle + x + z, middle - x + z};
    view.lamp.triangles = {V3u(0, 1, 2), V3u(0, 2, 3)};
    // With power pi L (2 half)^2 and all of the area S of albedo 1/2, irradiance is 2 power / S, radiance
    // power / (pi S).
    const float area = 2.0f * (size.x * size.y + size.y * size.z + size.z * size.x);
    view.radiance = mean_radiance * area / (4.0f * half * half);
  }

  std::span<const Shape> shapes_;
  Box3f bounds_;
  RayCaster caster_;
};

}  // namespace

std::optional<RoomView> find_room_view(std::span<const Shape> shapes) { return Surroundings(shapes).find(); }

}  // namespace twopass
