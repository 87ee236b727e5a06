#include "render/scene/scene.h"

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

std::vector<std::vector<Scene::Face>> Scene::faces_of(std::span<const Shape> shapes) {
  std::vector<std::vector<Face>> faces(shapes.size());
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    const auto* mesh = std::get_if<Mesh>(&shapes[s].geometry);
    if (!mesh) continue;
    faces[s].resize(mesh->triangles.size());
    for (std::uint32_t i = 0; i < mesh->triangles.size(); ++i) {
      const auto p = corners(*mesh, i);
      faces[s][i] = {unit((p[1] - p[0]).cross(p[2] - p[0])), rounding_offset(p)};
    }
  }
  return faces;
}

Scene::Scene(SceneDescription description)
    : description_(std::move(description)),
      faces_(faces_of(description_.shapes)),
      bounds_(bounds_of(description_.shapes)),
      caster_(description_.shapes),
      environment_(description_.sky),
      lights_(description_.shapes, {}, environment_, bounds_) {}

}  // namespace twopass
