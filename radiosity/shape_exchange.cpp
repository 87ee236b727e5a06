#include "radiosity/shape_exchange.h"

#include "radiosity/form_factor_pair.h"
#include "render/core/warp.h"
#include "render/scene/geometry.h"

namespace twopass {

namespace {

double mesh_exchange(std::span<const Patch> a, std::span<const Patch> b, double relative_accuracy) {
  double sum = 0.0;
  for (const Patch& p : a)
    for (const Patch& q : b) sum += exchange_exact(p.polygon(), q.polygon(), relative_accuracy);
  return sum;
}

bool contains(const Sphere& sphere, const V3d& centre, double radius) {
  return (centre - V3d(sphere.center)).length() + radius <= double(sphere.radius);
}

std::optional<double> sphere_and_triangle(const Sphere& sphere, const Patch& triangle) {
  if (sphere.inward) {
    for (const V3d& corner : triangle.corner)
      if (!contains(sphere, corner, 0.0)) return std::nullopt;
    return triangle.area;
  }
  const V3d centre(sphere.center);
  const double radius = sphere.radius, height = triangle.normal.dot(centre - triangle.corner[0]);
  if (height <= -radius) return 0.0;
  if (height < radius) return std::nullopt;
  std::array<V3d, 3> direction;
  for (int k = 0; k < 3; ++k) direction[k] = (triangle.corner[k] - centre).normalized();
  return radius * radius * std::abs(spherical_triangle_solid_angle(direction[0], direction[1], direction[2]));
}

std::optional<double> sphere_and_mesh(const Sphere& sphere, std::span<const Patch> mesh) {
  double sum = 0.0;
  for (const Patch& triangle : mesh) {
    const std::optional<double> exchange = sphere_and_triangle(sphere, triangle);
    if (!exchange) return std::nullopt;
    sum += *exchange;
  }
  return sum;
}

std::optional<double> spheres(const Sphere& a, const Sphere& b) {
  if (a.inward == b.inward) return std::nullopt;
  const Sphere &outer = a.inward ? a : b, &inner = a.inward ? b : a;
  if (!contains(outer, V3d(inner.center), inner.radius)) return std::nullopt;
  return 4.0 * pi * double(inner.radius) * double(inner.radius);
}

// Circles on one axis: F_ab = 2 q / (s + sqrt(s^2 - 4 q)), q = (r_b / r_a)^2, s = 1 + (h^2 + r_b^2) / r_a^2.
std::optional<double> disks(const Disk& a, const Disk& b) {
  constexpr double tolerance = 1e-5;
  const auto is_circle = [](const Disk& disk) {
    const double x = V3d(disk.x).length(), y = V3d(disk.y).length();
    return std::abs(x - y) <= tolerance * x && std::abs(V3d(disk.x).dot(V3d(disk.y))) <= tolerance * x * y;
  };
  if (!is_circle(a) || !is_circle(b)) return std::nullopt;
  const V3d normal_a = V3d(unit_normal(a)), normal_b = V3d(unit_normal(b)),
            between = V3d(b.center) - V3d(a.center);
  const double distance = between.length(), height_b = normal_a.dot(between), height_a = -normal_b.dot(between);
  if (normal_a.cross(normal_b).length() > tolerance || std::abs(height_b) < (1.0 - tolerance) * distance ||
      !(distance > 0.0))
    return std::nullopt;
  if (height_a < 0.0 || height_b < 0.0) return 0.0;
  const double ra2 = V3d(a.x).dot(V3d(a.x)), rb2 = V3d(b.x).dot(V3d(b.x));
  const double s = 1.0 + (distance * distance + rb2) / ra2, q = rb2 / ra2;
  return area_of(a) * 2.0 * q / (s + std::sqrt(s * s - 4.0 * q));
}

// What the inside of a cylinder without caps sees of itself: 1 + h - sqrt(1 + h^2), h = length / (2 radius).
double own_exchange(const Cylinder& cylinder) {
  if (!cylinder.inward) return 0.0;
  const double h = 0.5 * cylinder.length / cylinder.radius;
  return area_of(cylinder) * 2.0 * h / (1.0 + h + std::sqrt(1.0 + h * h));
}

}  // namespace

std::optional<double> unoccluded_exchange(const Scene& scene, const ShapeFronts& fronts, std::uint32_t a,
                                          std::uint32_t b, double relative_accuracy) {
  const auto* sphere_a = std::get_if<Sphere>(&scene.shapes()[a].geometry);
  const auto* sphere_b = std::get_if<Sphere>(&scene.shapes()[b].geometry);
  const auto* disk_a = std::get_if<Disk>(&scene.shapes()[a].geometry);
  const auto* disk_b = std::get_if<Disk>(&scene.shapes()[b].geometry);
  const auto* cylinder_a = std::get_if<Cylinder>(&scene.shapes()[a].geometry);
  if (disk_a && a == b) return 0.0;
  if (disk_a && disk_b) return disks(*disk_a, *disk_b);
  if (cylinder_a && a == b) return own_exchange(*cylinder_a);
  if (disk_a || disk_b || cylinder_a || std::holds_alternative<Cylinder>(scene.shapes()[b].geometry))
    return std::nullopt;
  if (sphere_a && a == b) return sphere_a->inward ? fronts.area[a] : 0.0;
  if (sphere_a && sphere_b) return spheres(*sphere_a, *sphere_b);
  if (sphere_a) return sphere_and_mesh(*sphere_a, fronts.patches_of(b));
  if (sphere_b) return sphere_and_mesh(*sphere_b, fronts.patches_of(a));
  return mesh_exchange(fronts.patches_of(a), fronts.patches_of(b), relative_accuracy);
}

}  // namespace twopass
