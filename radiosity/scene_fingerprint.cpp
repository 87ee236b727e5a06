#include "radiosity/scene_fingerprint.h"

#include "render/scene/data_hash.h"

namespace twopass {

namespace {

// What decides how a model scatters. A new model does not compile without its own.
void add_model(DataHash& hash, const Diffuse& model) { hash.add(model.reflectance); }
void add_model(DataHash& hash, const Conductor& model) {
  hash.add(model.eta);
  hash.add(model.k);
  hash.add(model.specular_reflectance);
}
void add_model(DataHash& hash, const Dielectric& model) {
  hash.add(model.eta);
  hash.add(model.specular_reflectance);
  hash.add(model.specular_transmittance);
}

void add_geometry(DataHash& hash, const Mesh& mesh) {
  hash.add(std::uint64_t{mesh.positions.size()});
  for (const V3f& p : mesh.positions) hash.add(p);
  hash.add(std::uint64_t{mesh.normals.size()});
  for (const V3f& n : mesh.normals) hash.add(n);
  hash.add(std::uint64_t{mesh.triangles.size()});
  for (const V3u& t : mesh.triangles) hash.add(t);
}
void add_geometry(DataHash& hash, const Sphere& sphere) {
  hash.add(sphere.center);
  hash.add(sphere.radius);
  hash.add(std::uint64_t{sphere.inward});
}

}  // namespace

std::uint64_t scene_fingerprint(const Scene& scene) {
  DataHash hash;
  hash.add(std::uint64_t{scene.shapes().size()});
  for (const Shape& shape : scene.shapes()) {
    hash.add(std::uint64_t{shape.geometry.index()});
    std::visit([&](const auto& geometry) { add_geometry(hash, geometry); }, shape.geometry);
    for (const Bsdf& bsdf : scene.description().materials[shape.material].side) {
      hash.add(std::uint64_t{bsdf.index()});
      std::visit([&](const auto& model) { add_model(hash, model); }, bsdf);
    }
    for (const C3f& radiance : shape.radiance) hash.add(radiance);
  }
  hash.add(std::uint64_t{scene.punctual_lights().size()});
  for (const PunctualLight& light : scene.punctual_lights()) hash.add(fingerprint(light));
  hash.add(scene.environment().fingerprint());
  return hash.value();
}

}  // namespace twopass
