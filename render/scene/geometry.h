// Small geometric facts that the ray caster, the lights and the surface points share.
#pragma once

#include <array>

#include "render/scene/shape.h"

namespace twopass {

/// The corners of a mesh's triangle.
inline std::array<V3f, 3> corners(const Mesh& mesh, std::uint32_t triangle) {
  const V3u& index = mesh.triangles[triangle];
  return {mesh.positions[index.x], mesh.positions[index.y], mesh.positions[index.z]};
}

/// How far from the surface a ray must start or end to clear rounding errors: a few units in the last place of
/// the largest coordinate, so that it scales with the scene and knows no absolute length.
inline float rounding_offset(const std::array<V3f, 3>& p) {
  const float largest = std::max({max_abs_component(p[0]), max_abs_component(p[1]), max_abs_component(p[2])});
  return 16.0f * std::numeric_limits<float>::epsilon() * largest;
}
inline float rounding_offset(const Sphere& sphere) {
  return 16.0f * std::numeric_limits<float>::epsilon() * (max_abs_component(sphere.center) + sphere.radius);
}

/// Points that new rays start from keep this many offsets away from the edges of their triangle. That clears
/// the triangle beyond the edge as well, if the two make an angle of at least 15 degrees.
inline constexpr float edge_clearance = 4.0f;

/// The barycentric coordinate below which a point of the triangle may be within edge_clearance * offset of an
/// edge; infinity without an area.
inline float near_edge(const std::array<V3f, 3>& p, float offset) {
  const float longest = std::max({(p[1] - p[0]).length(), (p[2] - p[1]).length(), (p[0] - p[2]).length()});
  const float least_height = (p[1] - p[0]).cross(p[2] - p[0]).length() / longest;
  return least_height > 0.0f ? edge_clearance * offset / least_height : infinity_f;
}

/// A point of a triangle, moved into it from all edges that are nearer than edge_clearance * offset (L40): by
/// as much as is missing, at right angles to the edge, and at most to a third of the triangle's height, so that
/// neither slivers nor sharp corners move it further than that. `normal`: of the triangle's front, unit;
/// `barycentric`: the point's.
inline V3f clear_of_edges(const V3f& point, const std::array<V3f, 3>& p, const V3f& normal,
                          const std::array<float, 3>& barycentric, float offset) {
  V3f moved = point;
  for (std::size_t i = 0; i < 3; ++i) {
    const V3f& start = p[(i + 1) % 3];
    const V3f inward = unit(normal.cross(p[(i + 2) % 3] - start));
    const float height = inward.dot(p[i] - start);
    const float missing = std::min(edge_clearance * offset, height / 3.0f) - barycentric[i] * height;
    if (missing > 0.0f) moved += inward * missing;
  }
  return moved;
}

/// The two distances at which a line meets a sphere, ascending, in units of the direction's length. False: it
/// misses.
inline bool intersect_sphere(const Sphere& sphere, const V3f& origin, const V3f& direction, double& near,
                             double& far) {
  // In double and from the nearest point to the centre, so that large distances do not cancel the radius away.
  const V3d d(direction), to_center = V3d(sphere.center) - V3d(origin);
  const double d2 = d.dot(d);
  if (d2 == 0.0) return false;
  const double middle = to_center.dot(d) / d2;
  const V3d miss = to_center - d * middle;
  const double radius = sphere.radius;
  const double half2 = (radius * radius - miss.dot(miss)) / d2;
  if (half2 < 0.0) return false;
  const double half = std::sqrt(half2);
  near = middle - half;
  far = middle + half;
  return true;
}

}  // namespace twopass
