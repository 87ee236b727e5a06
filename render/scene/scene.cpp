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

Scene::Scene(SceneDescription description)
    : description_(std::move(description)),
      bounds_(bounds_of(description_.shapes)),
      caster_(description_.shapes),
      lights_(description_.shapes) {}

}  // namespace twopass
