#include "render/load/mitsuba_clip.h"

namespace twopass {
namespace {

/// Smallest distance of the origin from a segment.
double distance_to_segment(const V3d& a, const V3d& b) {
  const V3d ab = b - a;
  const double t = std::clamp(-a.dot(ab) / ab.dot(ab), 0.0, 1.0);
  return (a + ab * t).length();
}

/// Smallest distance of the origin from a triangle that has an area.
double distance_to_triangle(const V3d& a, const V3d& b, const V3d& c) {
  const V3d n = (b - a).cross(c - a);
  // The origin projects into the triangle when it lies on the inner side of all three edges.
  const bool inside =
      n.dot((b - a).cross(-a)) >= 0.0 && n.dot((c - b).cross(-b)) >= 0.0 && n.dot((a - c).cross(-c)) >= 0.0;
  if (inside) return std::abs(a.dot(n)) / n.length();
  return std::min({distance_to_segment(a, b), distance_to_segment(b, c), distance_to_segment(c, a)});
}

/// What there is in front of a camera: distance of the nearest surface, depth of the farthest.
struct Reach {
  double nearest = infinity_f, deepest = 0.0;
};

/// Whether a box keeps clear of both planes, so that what is in it need not be looked at.
bool is_clear(const Box3f& box, const V3d& origin, const V3d& forward, const ClipPlanes& clip) {
  V3d nearest, deepest;
  for (int k = 0; k < 3; ++k) {
    nearest[k] = std::clamp(origin[k], double{box.min[k]}, double{box.max[k]});
    deepest[k] = forward[k] > 0.0 ? box.max[k] : box.min[k];
  }
  return (nearest - origin).length() >= clip.near && (deepest - origin).dot(forward) <= clip.far;
}

/// Points of a disk or cylinder.
std::vector<V3d> points_of(const Geometry& geometry) {
  constexpr int steps = 32;
  std::vector<V3d> points;
  for (int i = 0; i <= steps; ++i) {
    const double x = std::cos(2.0 * pi * i / steps), y = std::sin(2.0 * pi * i / steps);
    for (int j = 0; j <= steps; ++j) {
      const double part = static_cast<double>(j) / steps;
      if (const auto* disk = std::get_if<Disk>(&geometry)) {
        points.push_back(V3d(disk->center) + (V3d(disk->x) * x + V3d(disk->y) * y) * part);
        continue;
      }
      const auto& cylinder = std::get<Cylinder>(geometry);
      const V3d around = V3d(cylinder.axes[0]) * x + V3d(cylinder.axes[1]) * y;
      points.push_back(V3d(cylinder.base) + V3d(cylinder.axes[2]) * (part * cylinder.length) +
                       around * static_cast<double>(cylinder.radius));
    }
  }
  return points;
}

Reach reach_of(const SceneDescription& scene, const ClipPlanes& clip) {
  const M44d& m = scene.camera->to_world;
  const V3d origin(m[3][0], m[3][1], m[3][2]), forward(m[2][0], m[2][1], m[2][2]);
  Reach reach;
  const auto add = [&](double depth, double distance) {
    reach.deepest = std::max(reach.deepest, depth);
    if (depth > 0.0) reach.nearest = std::min(reach.nearest, distance);
  };
  for (const Shape& shape : scene.shapes) {
    const Box3f box = bounds_of({&shape, 1});
    if (box.isEmpty() || is_clear(box, origin, forward, clip)) continue;
    if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
      const V3d center = V3d(sphere->center) - origin;
      add(center.dot(forward) + sphere->radius, std::abs(center.length() - sphere->radius));
    } else if (const Mesh* mesh = mesh_of(shape.geometry)) {
      for (std::uint32_t t = 0; t < mesh->triangles.size(); ++t) {
        const std::array<V3f, 3> p = corners(shape.geometry, t);
        const V3d a = V3d(p[0]) - origin, b = V3d(p[1]) - origin, c = V3d(p[2]) - origin;
        add(std::max({a.dot(forward), b.dot(forward), c.dot(forward)}), distance_to_triangle(a, b, c));
      }
    } else {
      for (const V3d& p : points_of(shape.geometry)) add((p - origin).dot(forward), (p - origin).length());
    }
  }
  return reach;
}

}  // namespace

void note_clipping(const SceneDescription& scene, const ClipPlanes& clip, Notes& notes) {
  if (!(clip.near > 0.0) && !(clip.far < infinity_f)) return;
  const Reach reach = reach_of(scene, clip);
  if (reach.nearest < clip.near) notes.add(clip.where + ": near_clip is not applied, and something is nearer");
  if (reach.deepest > clip.far)
    notes.add(clip.where + ": far_clip is not applied, and the scene reaches beyond it");
}

}  // namespace twopass
