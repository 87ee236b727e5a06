#include "render/load/load_gltf_scene.h"

#include "render/core/error.h"
#include "render/load/gltf_camera.h"
#include "render/load/gltf_lights.h"
#include "render/load/gltf_materials.h"
#include "render/load/gltf_mesh.h"
#include "render/load/mesh_colors.h"
#include "render/load/mesh_tools.h"
#include "render/load/shape_group.h"

namespace twopass {
namespace {

/// The triangles of a mesh whose texture coordinates are mirrored (v points down: those that run
/// counter-clockwise), or those where they are not.
Mesh part_of(const Mesh& mesh, bool mirrored) {
  Mesh part = mesh;
  std::erase_if(part.triangles, [&](const V3u& t) {
    const V2f &a = mesh.uvs[t.x], &b = mesh.uvs[t.y], &c = mesh.uvs[t.z];
    return ((b - a).cross(c - a) > 0.0f) != mirrored;
  });
  return part;
}

/// A primitive of fewer triangles is copied for every node that shows it: an instance costs rays a detour, and
/// about as much memory as ten triangles.
constexpr std::size_t least_shared_triangles = 256;
/// What an instance counts in the budget, in corners of triangles.
constexpr std::size_t corners_of_instance = 30;

class SceneBuilder {
 public:
  SceneBuilder(const GltfDocument& document, const TextureOptions& textures, LoadedScene& loaded, Notes& notes)
      : document_(document),
        scene_(loaded.scene),
        tiled_textures_(loaded.tiled_textures),
        notes_(notes),
        textures_(document, textures, notes),
        materials_(document, textures_, loaded.scene, notes) {}

  void add_meshes(const std::vector<GltfPlace>& places) {
    for (const GltfPlace& place : places) ++uses_[document_.model.nodes[place.node].mesh];
    std::map<int, std::size_t> uses_left = uses_;
    for (const GltfPlace& place : places) {
      const int mesh = document_.model.nodes[place.node].mesh;
      if (mesh >= 0) add_mesh(place, mesh);
      if (--uses_left[mesh] == 0) primitives_.erase(mesh);
    }
    textures_.report();
    tiled_textures_ = textures_.tiled();
    const std::vector<std::string> losses = describe_losses();
    if (scene_.shapes.empty()) {
      std::string what = "no mesh with triangles hangs in its scene";
      for (const std::string& loss : losses) what.append(", ").append(loss);
      throw Error(document_.file, what, "give a file with something to render");
    }
    for (const std::string& loss : losses) notes_.add(document_.file + ": " + loss);
  }

 private:
  using Primitives = std::vector<std::optional<GltfPrimitive>>;

  /// The mesh's primitives, read once however many nodes use it.
  const Primitives& primitives_of(int index, const tinygltf::Mesh& mesh, const std::string& name) {
    const auto [entry, is_new] = primitives_.try_emplace(index);
    if (is_new)
      for (const tinygltf::Primitive& primitive : mesh.primitives) {
        entry->second.push_back(read_gltf_primitive(document_, primitive, name, losses_));
        check_budget();
      }
    return entry->second;
  }

  void add_mesh(const GltfPlace& place, int index) {
    const std::string node = name_of_node(document_, place.node);
    const tinygltf::Mesh& mesh =
        element_of(document_.model.meshes, index, "mesh", "node '" + node + "'", document_);
    const std::string mesh_name = mesh.name.empty() ? std::to_string(index) : mesh.name;
    const Primitives& primitives = primitives_of(index, mesh, mesh_name);
    std::string name = document_.model.nodes[place.node].name;
    if (name.empty()) name = mesh.name.empty() ? node : mesh.name;
    for (std::size_t i = 0; i < primitives.size(); ++i)
      if (primitives[i])
        add_primitive(place, {index, i}, *primitives[i], mesh.primitives[i].material,
                      "mesh '" + mesh_name + "'",
                      primitives.size() > 1 ? name + suffix(mesh.primitives[i].material, i) : name);
  }

  [[nodiscard]] std::string suffix(int material, std::size_t primitive) const {
    const auto& materials = document_.model.materials;
    if (material >= 0 && static_cast<std::size_t>(material) < materials.size())
      if (const std::string& name = materials[static_cast<std::size_t>(material)].name; !name.empty())
        return std::string(":").append(name);
    return std::string(":").append(std::to_string(primitive));
  }

  void add_primitive(const GltfPlace& place, const std::pair<int, std::size_t>& key,
                     const GltfPrimitive& primitive, int material, const std::string& user,
                     const std::string& name) {
    const bool mirrors = is_mirroring(place.to_world), has_bumps = looks_at_bumps(material, primitive);
    std::vector<Shape> shapes;
    // Bumps come out as dents on a mirror image: it needs another material.
    if (uses_[key.first] > 1 && primitive.mesh.triangles.size() >= least_shared_triangles &&
        !(mirrors && has_bumps) && ShapeGroup::is_placeable(place.to_world)) {
      auto group = groups_.find(key);
      if (group == groups_.end())
        group = groups_.try_emplace(key, shapes_of(primitive, M44d(), "", material, has_bumps, user)).first;
      if (!group->second.emits()) {
        losses_.corners += corners_of_instance;
        check_budget();
        shapes = group->second.place(place.to_world, name, where_of(place), notes_);
      }
    }
    if (shapes.empty()) {
      losses_.corners += 3 * primitive.mesh.triangles.size();
      check_budget();
      shapes = shapes_of(primitive, place.to_world, where_of(place), material, has_bumps, user);
      for (Shape& shape : shapes) shape.name = name;
    }
    for (Shape& shape : shapes) scene_.shapes.push_back(std::move(shape));
  }

  [[nodiscard]] bool looks_at_bumps(int material, const GltfPrimitive& primitive) const {
    return material >= 0 && static_cast<std::size_t>(material) < document_.model.materials.size() &&
           document_.model.materials[static_cast<std::size_t>(material)].normalTexture.index >= 0 &&
           !(primitive.uvs[0].empty() && primitive.uvs[1].empty());
  }

  [[nodiscard]] std::string where_of(const GltfPlace& place) const {
    return document_.file + ": node '" + name_of_node(document_, place.node) + "'";
  }

  /// The primitive at `to_world`, divided where a material looks different on mirrored texture coordinates;
  /// without names.
  std::vector<Shape> shapes_of(const GltfPrimitive& primitive, const M44d& to_world, const std::string& where,
                               int material, bool has_bumps, const std::string& user) {
    Mesh mesh = primitive.mesh;
    GltfVertexData vertices{.colors = !primitive.colors.empty()};
    const GltfSurface& surface = materials_.of(material, vertices, user);
    if (vertices.colors) mesh.attributes.push_back({gltf_vertex_colors, primitive.colors});
    mesh.uvs = primitive.uvs[std::min(surface.uv_set, 1)];
    transform(mesh, to_world, where);
    if (is_mirroring(to_world)) reverse_winding(mesh);
    std::vector<Shape> shapes;
    if (!has_bumps || mesh.uvs.empty()) {
      add_shape(std::move(mesh), surface, shapes);
      return shapes;
    }
    add_shape(part_of(mesh, false), surface, shapes);
    Mesh mirrored = part_of(mesh, true);
    if (mirrored.triangles.empty()) return shapes;
    vertices.mirrored = true;
    add_shape(std::move(mirrored), materials_.of(material, vertices, user), shapes);
    return shapes;
  }

  void add_shape(Mesh mesh, const GltfSurface& surface, std::vector<Shape>& shapes) {
    losses_.without_area += drop_degenerate_triangles(mesh);
    if (mesh.triangles.empty()) return;
    drop_flat_normals(mesh);
    Shape shape;
    shape.geometry = std::move(mesh);
    shape.material = surface.material;
    shape.radiance = surface.radiance;
    shape.radiance_texture = surface.radiance_texture;
    bind_mesh_colors(shape, scene_.materials, document_.file);
    if (surface.both_sides_emit) shape.radiance[back] = shape.radiance[front];
    shapes.push_back(std::move(shape));
  }

  /// A small file can ask for the same large mesh again and again.
  void check_budget() const {
    const std::size_t most = 3 * (1'000'000 + 4 * document_.size);
    if (losses_.corners > most)
      throw Error(document_.file,
                  "its nodes and primitives repeat more than " + std::to_string(most / 3) +
                      " triangles, too many for a file of its size",
                  "store the meshes that repeat less often");
  }

  [[nodiscard]] std::vector<std::string> describe_losses() const {
    std::vector<std::string> result;
    const auto add = [&](std::size_t count, const char* what) {
      if (count > 0) result.push_back(std::to_string(count) + " " + what);
    };
    add(losses_.not_triangles, "primitives made of points or lines are left out");
    add(losses_.bad_indices, "triangles with indices out of range are left out");
    add(losses_.not_finite, "triangles with coordinates that are not finite or too large are left out");
    add(losses_.without_area, "triangles without area are left out");
    add(losses_.morph_targets, "primitives with morph targets are rendered without them");
    return result;
  }

  const GltfDocument& document_;
  SceneDescription& scene_;
  std::vector<TiledTexture>& tiled_textures_;
  Notes& notes_;
  GltfTextures textures_;
  GltfMaterials materials_;
  GltfLosses losses_;
  std::map<int, Primitives> primitives_;
  std::map<int, std::size_t> uses_;                           // of meshes, by nodes
  std::map<std::pair<int, std::size_t>, ShapeGroup> groups_;  // by mesh and primitive
};

}  // namespace

LoadedScene load_gltf_scene(const std::filesystem::path& path, const TextureOptions& textures) {
  LoadedScene loaded;
  Notes notes;
  const GltfDocument document = read_gltf(path, notes);
  const std::vector<GltfPlace> places = gltf_places(document);
  loaded.scene.camera = read_gltf_camera(document, places, loaded.settings, notes);
  loaded.scene.punctual_lights = read_gltf_lights(document, places, notes, loaded.scene.punctual_light_groups);
  SceneBuilder(document, textures, loaded, notes).add_meshes(places);
  bool has_skins = false;
  for (const tinygltf::Node& node : document.model.nodes) has_skins |= node.skin >= 0;
  if (has_skins) notes.add(document.file + ": skins are not applied: meshes stand in their default pose");
  loaded.notes = notes.lines();
  return loaded;
}

}  // namespace twopass
