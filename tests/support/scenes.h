// Small scenes with known answers, built without files.
#pragma once

#include <string>

#include "render/scene/scene.h"

namespace twopass::test {

/// A quad p, p + a, p + a + b, p + b as two triangles; its front is the side of a x b.
inline Mesh quad(const V3f& p, const V3f& a, const V3f& b) {
  Mesh mesh;
  mesh.positions = {p, p + a, p + a + b, p + b};
  mesh.triangles = {V3u(0, 1, 2), V3u(0, 2, 3)};
  return mesh;
}

/// Adds a shape of a one-sided diffuse material of its own.
inline Shape& add_diffuse(SceneDescription& scene, std::string name, Geometry geometry, const C3f& reflectance,
                          const C3f& radiance = C3f(0.0f)) {
  scene.materials.push_back(one_sided(name, Diffuse{reflectance}));
  Shape shape;
  shape.name = std::move(name);
  shape.geometry = std::move(geometry);
  shape.material = static_cast<std::uint32_t>(scene.materials.size() - 1);
  shape.radiance[front] = radiance;
  scene.shapes.push_back(std::move(shape));
  return scene.shapes.back();
}

/// The unit cube seen from inside: floor, ceiling, left (x=0), right (x=1), near (y=0), far (y=1), in this
/// order.
inline SceneDescription unit_room(const C3f& reflectance, const C3f& ceiling_radiance,
                                  const C3f& ceiling_reflectance) {
  const V3f x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), o(0, 0, 0);
  SceneDescription scene;
  add_diffuse(scene, "floor", quad(o, x, y), reflectance);
  add_diffuse(scene, "ceiling", quad(z, y, x), ceiling_reflectance, ceiling_radiance);
  add_diffuse(scene, "left", quad(o, y, z), reflectance);
  add_diffuse(scene, "right", quad(x, z, y), reflectance);
  add_diffuse(scene, "near", quad(o, z, x), reflectance);
  add_diffuse(scene, "far", quad(y, x, z), reflectance);
  return scene;
}

/// The constant-radiance furnace: every surface emits (1 - albedo) L0, so radiance is L0 everywhere.
inline SceneDescription furnace_room(const C3f& reflectance, float l0) {
  SceneDescription scene = unit_room(reflectance, C3f(0.0f), reflectance);
  for (Shape& shape : scene.shapes) shape.radiance[front] = (C3f(1.0f) - reflectance) * l0;
  return scene;
}

/// Adds the front sides of an axis-aligned box, seen from outside.
inline void add_box(SceneDescription& scene, const std::string& name, const V3f& lo, const V3f& hi,
                    const Material& material) {
  scene.materials.push_back(material);
  const V3f x(hi.x - lo.x, 0, 0), y(0, hi.y - lo.y, 0), z(0, 0, hi.z - lo.z);
  Mesh box;
  const auto add = [&](const Mesh& face) {
    const auto base = static_cast<std::uint32_t>(box.positions.size());
    box.positions.insert(box.positions.end(), face.positions.begin(), face.positions.end());
    for (const V3u& t : face.triangles) box.triangles.emplace_back(t.x + base, t.y + base, t.z + base);
  };
  add(quad(lo, y, x));
  add(quad(lo + z, x, y));
  add(quad(lo, z, y));
  add(quad(lo + x, y, z));
  add(quad(lo, x, z));
  add(quad(lo + y, z, x));
  Shape shape;
  shape.name = name;
  shape.geometry = box;
  shape.material = static_cast<std::uint32_t>(scene.materials.size() - 1);
  scene.shapes.push_back(shape);
}

/// A room with a small lamp below its ceiling and a box on the floor: direct light, shadows, colour bleeding.
inline SceneDescription furnished_room() {
  SceneDescription scene = unit_room(C3f(0.7f, 0.6f, 0.5f), C3f(0.0f), C3f(0.7f));
  add_diffuse(scene, "lamp", quad(V3f(0.35f, 0.35f, 0.999f), V3f(0, 0.3f, 0), V3f(0.3f, 0, 0)), C3f(0.0f),
              C3f(10.0f));
  add_box(scene, "box", V3f(0.2f, 0.5f, 0.0f), V3f(0.45f, 0.75f, 0.4f), one_sided("box", Diffuse{C3f(0.6f)}));
  return scene;
}

}  // namespace twopass::test
