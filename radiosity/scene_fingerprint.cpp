#include "radiosity/scene_fingerprint.h"

#include <bit>
#include <unordered_map>

#include "render/scene/texture_hash.h"

namespace twopass {

namespace {

void add_model(DataHash& hash, const Bsdf& bsdf) {
  hash.add(std::uint64_t{bsdf.index()});
  std::visit(
      [&]<class Model>(const Model& model) {
        Model::visit_parameters(model, [&]<class Parameter>(std::string_view, const Parameter& parameter) {
          if constexpr (std::is_same_v<Parameter, float> || std::is_same_v<Parameter, C3f>)
            hash.add(parameter);
          else
            hash.add(static_cast<std::uint64_t>(parameter));
        });
      },
      bsdf);
}

void add_node(DataHash& hash, const MaterialNode& node);

void add_node_kind(DataHash& hash, const TexturedModel& model) {
  add_model(hash, model.bsdf);
  for (const TextureBinding& binding : model.textures) {
    hash.add(std::uint64_t{binding.parameter});
    add_texture(hash, binding.texture);
  }
}
void add_node_kind(DataHash& hash, const Mixture& mixture) {
  add_texture(hash, mixture.weight);
  add_node(hash, *mixture.first);
  add_node(hash, *mixture.second);
}
void add_options(DataHash& hash, const PerturbedNormal& options) {
  hash.add(std::uint64_t{options.flip_invalid} << 1 | std::uint64_t{options.soft_terminator});
}
void add_node_kind(DataHash& hash, const BumpMap& bump) {
  add_texture(hash, bump.height);
  hash.add(bump.scale);
  add_options(hash, bump.options);
  add_node(hash, *bump.nested);
}
void add_node_kind(DataHash& hash, const NormalMap& map) {
  add_texture(hash, map.normal);
  add_options(hash, map.options);
  add_node(hash, *map.nested);
}
void add_node(DataHash& hash, const MaterialNode& node) {
  hash.add(std::uint64_t{node.kind.index()});
  std::visit([&](const auto& kind) { add_node_kind(hash, kind); }, node.kind);
}

void add_side(DataHash& hash, const MaterialSide& side) {
  hash.add(std::uint64_t{side.is_uniform()});
  if (side.is_uniform())
    add_model(hash, side.uniform());
  else
    add_node(hash, *side.node());
}

// Meshes that instances share, each hashed once.
using KnownMeshes = std::unordered_map<const Mesh*, std::uint64_t>;

void add_geometry(DataHash& hash, const Mesh& mesh, KnownMeshes&) {
  hash.add(std::uint64_t{mesh.positions.size()});
  for (const V3f& p : mesh.positions) hash.add(p);
  hash.add(std::uint64_t{mesh.normals.size()});
  for (const V3f& n : mesh.normals) hash.add(n);
  hash.add(std::uint64_t{mesh.uvs.size()});
  for (const V2f& uv : mesh.uvs) {
    hash.add(uv.x);
    hash.add(uv.y);
  }
  hash.add(std::uint64_t{mesh.triangles.size()});
  for (const V3u& t : mesh.triangles) hash.add(t);
}
void add_geometry(DataHash& hash, const Sphere& sphere, KnownMeshes&) {
  hash.add(sphere.center);
  hash.add(sphere.radius);
  hash.add(std::uint64_t{sphere.inward});
  for (const V3f& axis : sphere.axes) hash.add(axis);
}
void add_geometry(DataHash& hash, const Disk& disk, KnownMeshes&) {
  for (const V3f& v : {disk.center, disk.x, disk.y}) hash.add(v);
  hash.add(std::uint64_t{disk.reversed});
}
void add_geometry(DataHash& hash, const Cylinder& cylinder, KnownMeshes&) {
  hash.add(cylinder.base);
  hash.add(cylinder.radius);
  hash.add(cylinder.length);
  hash.add(std::uint64_t{cylinder.inward});
  for (const V3f& axis : cylinder.axes) hash.add(axis);
}
void add_geometry(DataHash& hash, const MeshInstance& instance, KnownMeshes& known) {
  const auto [entry, is_new] = known.try_emplace(instance.mesh.get(), 0);
  if (is_new) {
    DataHash own;
    add_geometry(own, *instance.mesh, known);
    entry->second = own.value();
  }
  hash.add(entry->second);
  const Placement& p = instance.to_world;
  for (const V3f& v : {p.x, p.y, p.z, p.origin}) hash.add(v);
}

}  // namespace

std::uint64_t scene_fingerprint(const Scene& scene) {
  DataHash hash;
  KnownMeshes known;
  hash.add(std::uint64_t{scene.shapes().size()});
  for (const Shape& shape : scene.shapes()) {
    hash.add(std::uint64_t{shape.geometry.index()});
    std::visit([&](const auto& geometry) { add_geometry(hash, geometry, known); }, shape.geometry);
    for (const MaterialSide& side : scene.description().materials[shape.material].side) add_side(hash, side);
    for (const C3f& radiance : shape.radiance) hash.add(radiance);
    if (shape.radiance_texture) add_texture(hash, *shape.radiance_texture);
  }
  hash.add(std::uint64_t{scene.punctual_lights().size()});
  for (const PunctualLight& light : scene.punctual_lights()) hash.add(fingerprint(light));
  hash.add(scene.environment().fingerprint());
  const WorldFrame& frame = scene.description().frame;
  for (const double x : {frame.origin.x, frame.origin.y, frame.origin.z, frame.unit})
    hash.add(std::bit_cast<std::uint64_t>(x));
  return hash.value();
}

}  // namespace twopass
