#include "render/load/mitsuba_scene.h"

#include "render/core/error.h"
#include "render/load/mesh_colors.h"
#include "render/load/mitsuba_bsdfs.h"
#include "render/load/mitsuba_emitters.h"
#include "render/load/mitsuba_expand.h"
#include "render/load/mitsuba_instances.h"
#include "render/load/mitsuba_properties.h"
#include "render/load/mitsuba_references.h"
#include "render/load/mitsuba_sensor.h"
#include "render/load/mitsuba_shapes.h"
#include "render/load/shape_group.h"

namespace twopass {
namespace {

/// Reads the children of <scene> into a LoadedScene, in the order of the file.
class SceneReader {
 public:
  SceneReader(const MitsubaTree& tree, const TextureOptions& textures)
      : tree_(tree),
        texture_files_(textures),
        textures_(tree, texture_files_),
        materials_(tree, loaded_.scene.materials, textures_) {}

  LoadedScene run() {
    // All settings and materials before the first shape: meshes take long to read, errors should not.
    for (const XmlNode& node : tree_.root.children)
      if (node.tag != "shape") read(node);
    read_shapes();
    notes_.add(*tree_.repairs);
    texture_files_.report(notes_);
    loaded_.tiled_textures = texture_files_.tiled();
    loaded_.notes = notes_.lines();
    return std::move(loaded_);
  }

 private:
  void read(const XmlNode& node) {
    if (!is_object(node) && node.tag != "ref")
      throw Error(node.where(), "<" + node.tag + "> outside of an object",
                  "move it into the object that it belongs to");
    if (node.tag == "bsdf")
      materials_.of(node);
    else if (node.tag == "sensor")
      read_sensor(node);
    else if (node.tag == "integrator")
      read_integrator(node);
    else if (node.tag == "emitter")
      read_emitter(node);
    else if (node.tag == "ref")
      throw Error(node.where(), "a <ref> outside of an object", "move it into the object that uses it");
    else if (node.tag != "spectrum" && node.tag != "film" && node.tag != "sampler" && node.tag != "rfilter" &&
             node.tag != "texture")
      // Those five are read where something refers to them.
      refuse(node);
  }

  [[noreturn]] static void refuse(const XmlNode& node) {
    const std::string* type = node.find("type");
    std::string remedy = "a scene holds: bsdf, emitter, integrator, sensor, shape";
    if (const std::string_view advice = advice_on(node.tag, type ? *type : ""); !advice.empty())
      remedy.append("; ").append(advice).append("; --ignore-unsupported renders what is left");
    throw Unsupported({node.tag, type ? *type : "", ""}, node.where(), "<" + node.tag + "> is not supported",
                      remedy);
  }

  void read_sensor(const XmlNode& node) {
    if (loaded_.scene.camera) {
      notes_.add(node.where() + ": the scene has several sensors; the first one is used");
      return;
    }
    loaded_.scene.camera = read_mitsuba_sensor(node, tree_, loaded_.settings, notes_);
  }

  void read_integrator(const XmlNode& node) {
    if (integrator_)
      throw Error(node.where(), "a second integrator, the first is at " + integrator_->where(), "give one");
    integrator_ = &node;
    read_mitsuba_integrator(node, tree_, loaded_.settings, notes_);
  }

  void read_emitter(const XmlNode& node) {
    if (node.get("type") == "area")
      throw Error(node.where(), "emitter 'area' outside of a shape", "move it into the shape that emits");
    auto emitter = read_mitsuba_emitter(node, tree_, textures_);
    if (auto* light = std::get_if<PunctualLight>(&emitter)) {
      loaded_.scene.punctual_lights.push_back(std::move(*light));
      loaded_.scene.punctual_light_groups.push_back(light_group_of(node, tree_));
      return;
    }
    if (environment_)
      throw Error(
          node.where(),
          "a second environment, the first is '" + environment_->get("type") + "' at " + environment_->where(),
          "give one");
    environment_ = &node;
    loaded_.scene.environment = std::get<Environment>(std::move(emitter));
    if (const std::string group = light_group_of(node, tree_); !group.empty())
      loaded_.scene.environment_light_group = group;
  }

  void read_shapes() {
    // All that are read from elements, those of groups too, at once: meshes are read in parallel.
    NamedShapes elements;
    std::map<const XmlNode*, std::pair<std::size_t, std::size_t>> members;  // of groups: a range of elements
    const auto add = [&](const XmlNode& node, bool is_member) {
      elements.push_back({&node, node.get("type") + "-" + std::to_string(elements.size() + 1), is_member});
    };
    for (const XmlNode& node : tree_.root.children) {
      if (node.tag != "shape") continue;
      if (node.get("type") == "instance") {
        instances_.push_back(read_mitsuba_instance(node, tree_));
        continue;
      }
      const std::size_t first = elements.size();
      if (node.get("type") != "shapegroup") {
        add(node, false);
        continue;
      }
      for (const XmlNode* member : shapes_of_group(node, tree_)) add(*member, true);
      members[&node] = {first, elements.size()};
    }
    std::vector<Shape> shapes = read_mitsuba_shapes(elements, tree_, materials_, textures_, notes_);
    for (std::size_t i = 0; i < shapes.size(); ++i)
      bind_mesh_colors(shapes[i], loaded_.scene.materials, elements[i].node->where());
    place_shapes(std::move(shapes), members);
  }

  /// Shapes and instances in the order of the file.
  void place_shapes(std::vector<Shape> read,
                    const std::map<const XmlNode*, std::pair<std::size_t, std::size_t>>& members) {
    const auto is_seen = [](const Shape& shape) {
      const Mesh* mesh = mesh_of(shape.geometry);
      return !mesh || !mesh->triangles.empty();
    };
    std::map<const XmlNode*, ShapeGroup> groups;
    for (const auto& [node, range] : members) {
      std::vector<Shape> shapes;
      for (std::size_t i = range.first; i < range.second; ++i)
        if (is_seen(read[i])) shapes.push_back(std::move(read[i]));
      groups.emplace(node, ShapeGroup(std::move(shapes)));
    }
    std::vector<Shape>& shapes = loaded_.scene.shapes;
    std::size_t next = 0, instances = 0;
    for (const XmlNode& node : tree_.root.children) {
      if (node.tag != "shape") continue;
      if (const auto group = members.find(&node); group != members.end()) {
        next = group->second.second;
      } else if (node.get("type") == "instance") {
        const MitsubaInstance& instance = instances_[instances++];
        const std::string* id = node.find("id");
        const std::string name = id ? *id : "instance-" + std::to_string(instances);
        for (Shape& shape : groups.at(instance.group).place(instance.to_world, name, instance.where, notes_))
          shapes.push_back(std::move(shape));
      } else {
        if (is_seen(read[next])) shapes.push_back(std::move(read[next]));
        ++next;
      }
    }
  }

  const MitsubaTree& tree_;
  LoadedScene loaded_;
  Notes notes_;
  TextureFiles texture_files_;
  MitsubaTextures textures_;
  MitsubaMaterials materials_;
  const XmlNode* integrator_ = nullptr;
  const XmlNode* environment_ = nullptr;
  std::vector<MitsubaInstance> instances_;  // in the order of the file
};

// Transforms are double; floats, which positions become, have few digits left for what lies far from where they
// are counted from. A point to count from that is nearer where the scene is a thousand times as far from 0 as
// it is large, else 0. A float, so that what a file holds as floats loses nothing.
V3d better_origin(const Box3f& bounds) {
  constexpr double far = 1000.0;
  if (bounds.isEmpty()) return V3d(0.0);
  const V3f middle((bounds.min + bounds.max) * 0.5f), size = bounds.size();
  const double extent = std::max({size.x, size.y, size.z});
  return static_cast<double>(max_abs_component(middle)) > far * extent ? V3d(middle) : V3d(0.0);
}

}  // namespace

LoadedScene load_mitsuba_scene(const std::filesystem::path& path, const Definitions& definitions,
                               const TextureOptions& textures, bool ignore_unsupported) {
  // Whatever proves to be unsupported is left out of the next attempt. There are few kinds of features, and
  // nearly all are met before the first mesh is read.
  LeftOut left_out;
  for (;;) {
    try {
      left_out.restart();
      MitsubaTree tree = read_mitsuba(path, definitions, &left_out);
      check_references(tree);
      LoadedScene loaded = SceneReader(tree, textures).run();
      tree.origin = better_origin(bounds_of(loaded.scene.shapes));
      if (tree.origin != V3d(0.0)) {
        *tree.repairs = {};
        loaded = SceneReader(tree, textures).run();
        loaded.scene.frame.origin = tree.origin;
      }
      loaded.left_out = left_out.list();
      return loaded;
    } catch (const Unsupported& error) {
      if (!ignore_unsupported) throw;
      left_out.add(error);
    }
  }
}

}  // namespace twopass
