#include "radiosity/patch.h"

#include "render/core/warp.h"
#include "render/scene/geometry.h"

namespace twopass {

ElementPoint Patch::sample(const V2f& u) const {
  if (on_sphere) {
    std::array<V3d, 3> direction;
    for (int k = 0; k < 3; ++k) direction[k] = (corner[k] - center).normalized();
    // The map wants counter-clockwise corners seen from outside.
    if (signed_radius < 0.0) std::swap(direction[1], direction[2]);
    return on_sphere_towards(square_to_spherical_triangle(u.x, u.y, direction[0], direction[1], direction[2]));
  }
  return at(square_to_triangle(u));
}

ElementPoint Patch::at(const V2f& b) const {
  if (disk || cylinder) {
    const V2d place = parameter[0] + (parameter[1] - parameter[0]) * b.x + (parameter[2] - parameter[0]) * b.y;
    return above(disk ? point_of(*disk, place) : point_of(*cylinder, place));
  }
  const V3d flat = corner[0] + (corner[1] - corner[0]) * b.x + (corner[2] - corner[0]) * b.y;
  return on_sphere ? above(flat) : ElementPoint{flat, normal, offset};
}

ElementPoint Patch::centroid() const { return above((corner[0] + corner[1] + corner[2]) * (1.0 / 3.0)); }

ElementPoint Patch::above(const V3d& flat) const {
  if (on_sphere) return on_sphere_towards((flat - center).normalized());
  if (!cylinder) return {flat, normal, offset};
  const V3d axis = V3d(cylinder->axes[2]).normalized(), base(cylinder->base);
  const double height = axis.dot(flat - base);
  const V3d outward = (flat - base - axis * height).normalized();
  const bool is_outside = (side == front) != cylinder->inward;
  return {base + axis * height + outward * static_cast<double>(cylinder->radius),
          is_outside ? outward : -outward, offset};
}

ElementPoint Patch::on_sphere_towards(const V3d& outward) const {
  return {center + outward * std::abs(signed_radius), signed_radius < 0.0 ? -outward : outward, offset};
}

Patch triangle_patch(const Mesh& mesh, std::uint32_t triangle, Side side) {
  return triangle_patch(corners(mesh, triangle), side);
}

Patch triangle_patch(const std::array<V3f, 3>& p, Side side) {
  Patch patch;
  patch.corner = {V3d(p[0]), V3d(p[1]), V3d(p[2])};
  if (side == back) std::swap(patch.corner[1], patch.corner[2]);
  const V3d area_vector = polygon_area_vector(patch.polygon());
  patch.area = area_vector.length();
  patch.normal = patch.area > 0.0 ? area_vector / patch.area : V3d(0.0);
  patch.offset = rounding_offset(p);
  return patch;
}

std::array<V3d, 3> octant_corners(std::uint32_t octant) {
  const auto sign = [&](int axis) { return (octant >> axis) & 1u ? -1.0 : 1.0; };
  std::array<V3d, 3> corner{V3d(sign(0), 0.0, 0.0), V3d(0.0, sign(1), 0.0), V3d(0.0, 0.0, sign(2))};
  if (sign(0) * sign(1) * sign(2) < 0.0) std::swap(corner[1], corner[2]);
  return corner;
}

Patch spherical_patch(const Sphere& sphere, const std::array<V3d, 3>& direction, Side side) {
  const bool outside = (side == front) != sphere.inward;
  const double radius = sphere.radius;
  Patch patch;
  patch.on_sphere = true;
  patch.center = V3d(sphere.center);
  patch.signed_radius = outside ? radius : -radius;
  patch.area = radius * radius * spherical_triangle_solid_angle(direction[0], direction[1], direction[2]);
  patch.offset = rounding_offset(sphere);
  for (int k = 0; k < 3; ++k) patch.corner[k] = patch.center + direction[k] * radius;
  if (!outside) std::swap(patch.corner[1], patch.corner[2]);
  patch.normal = polygon_area_vector(patch.polygon()).normalized();
  return patch;
}

V3d point_of(const Disk& disk, const V2d& parameter) {
  const V2d at = square_to_disk_concentric(parameter);
  return V3d(disk.center) + V3d(disk.x) * at.x + V3d(disk.y) * at.y;
}

V3d point_of(const Cylinder& cylinder, const V2d& parameter) {
  // A whole turn is none, bit for bit.
  const double angle = 2.0 * pi * (parameter.x - std::floor(parameter.x));
  return V3d(cylinder.base) + V3d(cylinder.axes[2]) * (parameter.y * cylinder.length) +
         (V3d(cylinder.axes[0]) * std::cos(angle) + V3d(cylinder.axes[1]) * std::sin(angle)) *
             static_cast<double>(cylinder.radius);
}

namespace {

// All but what names the surface. `density`: its area over that of all parameters.
template <class Surface>
Patch patch_over(const Surface& surface, const std::array<V2d, 3>& parameter, double density, Side side) {
  Patch patch;
  patch.parameter = parameter;
  if (side == back) std::swap(patch.parameter[1], patch.parameter[2]);
  for (int k = 0; k < 3; ++k) patch.corner[k] = point_of(surface, patch.parameter[k]);
  const V2d a = parameter[1] - parameter[0], b = parameter[2] - parameter[0];
  patch.area = 0.5 * std::abs(a.x * b.y - a.y * b.x) * density;
  patch.normal = polygon_area_vector(patch.polygon()).normalized();
  patch.offset = rounding_offset(surface);
  patch.side = side;
  return patch;
}

}  // namespace

Patch parametric_patch(const Disk& disk, const std::array<V2d, 3>& parameter, Side side) {
  Patch patch = patch_over(disk, parameter, area_of(disk) / 4.0, side);
  patch.disk = &disk;
  return patch;
}

Patch parametric_patch(const Cylinder& cylinder, const std::array<V2d, 3>& parameter, Side side) {
  Patch patch = patch_over(cylinder, parameter, area_of(cylinder), side);
  patch.cylinder = &cylinder;
  return patch;
}

}  // namespace twopass
