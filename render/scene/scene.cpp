#include "render/scene/scene.h"

#include "render/scene/geometry.h"

namespace twopass {

Box3f bounds_of(std::span<const Shape> shapes) {
  Box3f box;
  for (const Shape& shape : shapes) {
    if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
      for (const V3f& p : mesh->positions) box.extendBy(p);
    } else {
      const Sphere& sphere = std::get<Sphere>(shape.geometry);
      box.extendBy(sphere.center - V3f(sphere.radius));
      box.extendBy(sphere.center + V3f(sphere.radius));
    }
  }
  return box;
}

Scene::Scene(SceneDescription description)
    : description_(std::move(description)),
      bounds_(bounds_of(description_.shapes)),
      caster_(description_.shapes),
      lights_(description_.shapes) {}

SurfacePoint Scene::surface_point(const Ray& ray, const Hit& hit) const {
  SurfacePoint point;
  point.shape = hit.shape;
  point.primitive = hit.primitive;
  point.u = hit.u;
  point.v = hit.v;
  const Shape& shape = description_.shapes[hit.shape];
  V3f normal, shading_normal;  // of the front
  if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
    const auto p = corners(*mesh, hit.primitive);
    const float w = 1.0f - hit.u - hit.v;
    point.position = p[0] * w + p[1] * hit.u + p[2] * hit.v;
    normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    point.offset = rounding_offset(p);
    shading_normal = normal;
    if (!mesh->normals.empty()) {
      const V3u& index = mesh->triangles[hit.primitive];
      const V3f n =
          mesh->normals[index.x] * w + mesh->normals[index.y] * hit.u + mesh->normals[index.z] * hit.v;
      if (n.dot(n) > 0.0f) shading_normal = n.normalized();
      // Normals that disagree with the winding by more than a right angle mean the same side, written inside
      // out.
      if (shading_normal.dot(normal) < 0.0f) shading_normal = -shading_normal;
    }
  } else {
    const Sphere& sphere = std::get<Sphere>(shape.geometry);
    const V3f outward = (ray.origin + ray.direction * hit.t - sphere.center).normalized();
    point.position = sphere.center + outward * sphere.radius;
    normal = sphere.inward ? -outward : outward;
    point.offset = rounding_offset(sphere);
    shading_normal = normal;
  }
  point.side = normal.dot(ray.direction) < 0.0f ? front : back;
  point.geometric_normal = point.side == front ? normal : -normal;
  if (point.side == back) shading_normal = -shading_normal;
  // A viewer below the shading horizon would see a black rim: there the geometric normal shades.
  if (shading_normal.dot(ray.direction) >= 0.0f) shading_normal = point.geometric_normal;
  point.shading = Frame(shading_normal);
  return point;
}

}  // namespace twopass
