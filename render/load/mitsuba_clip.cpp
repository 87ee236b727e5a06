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

Reach reach_of(const SceneDescription& scene) {
  const M44d& m = scene.camera->to_world;
  const V3d origin(m[3][0], m[3][1], m[3][2]), forward(m[2][0], m[2][1], m[2][2]);
  Reach reach;
  for (const Shape& shape : scene.shapes) {
    if (const Sphere* sphere = std::get_if<Sphere>(&shape.geometry)) {
      const V3d center = V3d(sphere->center) - origin;
      const double depth = center.dot(forward) + sphere->radius;
      reach.deepest = std::max(reach.deepest, depth);
      if (depth > 0.0) reach.nearest = std::min(reach.nearest, std::abs(center.length() - sphere->radius));
      continue;
    }
    const Mesh& mesh = std::get<Mesh>(shape.geometry);
    for (const V3u& t : mesh.triangles) {
      const V3d a = V3d(mesh.positions[t.x]) - origin, b = V3d(mesh.positions[t.y]) - origin,
                c = V3d(mesh.positions[t.z]) - origin;
      const double depth = std::max({a.dot(forward), b.dot(forward), c.dot(forward)});
      reach.deepest = std::max(reach.deepest, depth);
      if (depth > 0.0) reach.nearest = std::min(reach.nearest, distance_to_triangle(a, b, c));
    }
  }
  return reach;
}

}  // namespace

void note_clipping(const SceneDescription& scene, const ClipPlanes& clip, Notes& notes) {
  if (!(clip.near > 0.0) && !(clip.far < infinity_f)) return;
  const Reach reach = reach_of(scene);
  if (reach.nearest < clip.near) notes.add(clip.where + ": near_clip is not applied, and something is nearer");
  if (reach.deepest > clip.far)
    notes.add(clip.where + ": far_clip is not applied, and the scene reaches beyond it");
}

}  // namespace twopass
