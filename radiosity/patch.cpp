#include "radiosity/patch.h"

#include "render/core/warp.h"
#include "render/scene/geometry.h"

namespace twopass {

ElementPoint Patch::sample(const V2f& u) const {
  if (!on_sphere) {
    const V2f b = square_to_triangle(u);
    return {corner[0] + (corner[1] - corner[0]) * b.x + (corner[2] - corner[0]) * b.y, normal, offset};
  }
  std::array<V3d, 3> direction;
  for (int k = 0; k < 3; ++k) direction[k] = (corner[k] - center).normalized();
  // The map wants counter-clockwise corners seen from outside.
  if (signed_radius < 0.0) std::swap(direction[1], direction[2]);
  return on_sphere_towards(square_to_spherical_triangle(u.x, u.y, direction[0], direction[1], direction[2]));
}

ElementPoint Patch::centroid() const {
  const V3d middle = (corner[0] + corner[1] + corner[2]) * (1.0 / 3.0);
  if (!on_sphere) return {middle, normal, offset};
  return on_sphere_towards((middle - center).normalized());
}

ElementPoint Patch::on_sphere_towards(const V3d& outward) const {
  return {center + outward * std::abs(signed_radius), signed_radius < 0.0 ? -outward : outward, offset};
}

Patch triangle_patch(const Mesh& mesh, std::uint32_t triangle, Side side) {
  const std::array<V3f, 3> p = corners(mesh, triangle);
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

}  // namespace twopass
