#include "radiosity/shape_exchange.h"

#include "radiosity/form_factor_pair.h"
#include "render/core/warp.h"

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

}  // namespace

std::optional<double> unoccluded_exchange(const Scene& scene, const ShapeFronts& fronts, std::uint32_t a,
                                          std::uint32_t b, double relative_accuracy) {
  const auto* sphere_a = std::get_if<Sphere>(&scene.shapes()[a].geometry);
  const auto* sphere_b = std::get_if<Sphere>(&scene.shapes()[b].geometry);
  if (sphere_a && a == b) return sphere_a->inward ? fronts.area[a] : 0.0;
  if (sphere_a && sphere_b) return spheres(*sphere_a, *sphere_b);
  if (sphere_a) return sphere_and_mesh(*sphere_a, fronts.patches_of(b));
  if (sphere_b) return sphere_and_mesh(*sphere_b, fronts.patches_of(a));
  return mesh_exchange(fronts.patches_of(a), fronts.patches_of(b), relative_accuracy);
}

}  // namespace twopass
