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
