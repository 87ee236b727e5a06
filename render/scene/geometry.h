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

/// The triangles of a mesh or of an instance, in its own coordinates; nullptr: the shape is analytic.
inline const Mesh* mesh_of(const Geometry& geometry) {
  if (const auto* mesh = std::get_if<Mesh>(&geometry)) return mesh;
  const auto* instance = std::get_if<MeshInstance>(&geometry);
  return instance ? instance->mesh.get() : nullptr;
}
/// The corners of a triangle in the world. REQUIRES: mesh_of(geometry).
inline std::array<V3f, 3> corners(const Geometry& geometry, std::uint32_t triangle) {
  if (const auto* mesh = std::get_if<Mesh>(&geometry)) return corners(*mesh, triangle);
  const auto& instance = std::get<MeshInstance>(geometry);
  std::array<V3f, 3> p = corners(*instance.mesh, triangle);
  for (V3f& corner : p) corner = instance.to_world.point(corner);
  return p;
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

inline float rounding_offset(const Disk& disk) {
  return 16.0f * std::numeric_limits<float>::epsilon() *
         (max_abs_component(disk.center) + std::max(max_abs_component(disk.x), max_abs_component(disk.y)));
}
inline float rounding_offset(const Cylinder& cylinder) {
  return 16.0f * std::numeric_limits<float>::epsilon() *
         (max_abs_component(cylinder.base) + cylinder.length + cylinder.radius);
}
/// Of an instance: rays are carried into its coordinates and back, so that rounding counts in the world, at
/// `position`, and there, where it is `local_offset`; sheared axes make more of it, scaled ones do not.
inline float rounding_offset(const Placement& to_world, const V3f& position, float local_offset) {
  const V3f &x = to_world.x, &y = to_world.y, &z = to_world.z;
  const float largest = std::max({max_abs_component(x), max_abs_component(y), max_abs_component(z)});
  const float volume = std::abs(x.cross(y).dot(z));
  const float shear = volume > 0.0f ? x.length() * y.length() * z.length() / volume : 1.0f;
  const float world = max_abs_component(position) + max_abs_component(to_world.origin);
  return 3.0f * largest * local_offset +
         32.0f * std::numeric_limits<float>::epsilon() * std::min(shear, 1e3f) * world;
}

/// Areas and normals of analytic surfaces; the normal is that of a disk's front.
inline V3f unit_normal(const Disk& disk) {
  return unit(disk.reversed ? disk.y.cross(disk.x) : disk.x.cross(disk.y));
}
inline double area_of(const Disk& disk) { return pi * V3d(disk.x).cross(V3d(disk.y)).length(); }
inline double area_of(const Cylinder& cylinder) { return 2.0 * pi * cylinder.radius * cylinder.length; }

/// The box around an analytic surface.
inline Box3f box_of(const Sphere& sphere) {
  return Box3f(sphere.center - V3f(sphere.radius), sphere.center + V3f(sphere.radius));
}
inline Box3f box_of(const Disk& disk) {
  V3f half;
  for (int k = 0; k < 3; ++k) half[k] = std::hypot(disk.x[k], disk.y[k]);
  return Box3f(disk.center - half, disk.center + half);
}
inline Box3f box_of(const Cylinder& cylinder) {
  V3f half;
  for (int k = 0; k < 3; ++k) half[k] = cylinder.radius * std::hypot(cylinder.axes[0][k], cylinder.axes[1][k]);
  const V3f top = cylinder.base + cylinder.axes[2] * cylinder.length;
  Box3f box(cylinder.base - half, cylinder.base + half);
  box.extendBy(top - half);
  box.extendBy(top + half);
  return box;
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

/// The distance at which a line meets a disk, in units of the direction's length, and where: center + a x + b
/// y. False: it misses.
inline bool intersect_disk(const Disk& disk, const V3f& origin, const V3f& direction, double& t, V2d& at) {
  const V3d x(disk.x), y(disk.y), d(direction), to_center = V3d(disk.center) - V3d(origin);
  const V3d normal = x.cross(y);
  const double across = normal.dot(d), n2 = normal.dot(normal);
  if (across == 0.0 || n2 == 0.0) return false;
  t = normal.dot(to_center) / across;
  const V3d p = d * t - to_center;
  at = V2d(normal.dot(p.cross(y)) / n2, normal.dot(x.cross(p)) / n2);
  return at.x * at.x + at.y * at.y <= 1.0;
}

/// The two distances at which a line meets a cylinder without end, ascending, in units of the direction's
/// length, and how far along it that is: 0 at the base, 1 at the other end. False: it misses.
inline bool intersect_cylinder(const Cylinder& cylinder, const V3f& origin, const V3f& direction,
                               std::array<double, 2>& t, std::array<double, 2>& along) {
  // As for spheres: from the point nearest to the axis.
  const V3d axis = V3d(cylinder.axes[2]).normalized(), d(direction), from = V3d(origin) - V3d(cylinder.base);
  const V3d d_across = d - axis * axis.dot(d), from_across = from - axis * axis.dot(from);
  const double d2 = d_across.dot(d_across), radius = cylinder.radius;
  if (!(d2 > 0.0)) return false;
  const double middle = -from_across.dot(d_across) / d2;
  const V3d miss = from_across + d_across * middle;
  const double half2 = (radius * radius - miss.dot(miss)) / d2;
  if (half2 < 0.0) return false;
  const double half = std::sqrt(half2);
  t = {middle - half, middle + half};
  for (int k = 0; k < 2; ++k) along[k] = axis.dot(from + d * t[k]) / cylinder.length;
  return true;
}

/// The unit vector from the axis of a cylinder to a point near its surface, and where along the axis that is: 0
/// at the base, 1 at the other end.
inline V3f outward_at(const Cylinder& cylinder, const V3f& position, float& along) {
  const V3f from = position - cylinder.base, &axis = cylinder.axes[2];
  const float height = from.dot(axis);
  along = std::clamp(height / cylinder.length, 0.0f, 1.0f);
  return unit(from - axis * height);
}

}  // namespace twopass
