#include "render/load/mitsuba_shapes.h"

#include <functional>
#include <map>

#include "render/core/error.h"
#include "render/core/parallel.h"
#include "render/load/mesh_tools.h"
#include "render/load/mitsuba_analytic.h"
#include "render/load/mitsuba_properties.h"
#include "render/load/obj_mesh.h"
#include "render/load/ply_file.h"
#include "render/load/serialized_file.h"
#include "render/load/shape_group.h"

namespace twopass {
namespace {

/// What a file holds.
using MeshFromFile = SerializedMesh;

/// A mesh as its file has it, kept for the shapes that follow with the same file and the same options.
class ParsedMesh {
 public:
  ParsedMesh(std::size_t uses, bool can_be_shared) : uses_(uses), can_be_shared_(can_be_shared) {}
  /// The mesh, read at the first call. REQUIRES: at most as many calls as there are uses, `read` always the
  /// same.
  MeshFromFile get(const std::function<MeshFromFile()>& read) {
    if (!mesh_) mesh_ = read();
    return --uses_ > 0 ? *mesh_ : std::move(*mesh_);
  }
  /// Whether it is worth it that all shapes share one mesh, as instances.
  bool is_shared(const std::function<MeshFromFile()>& read) {
    if (!can_be_shared_ || uses_ < 2) return group_.has_value();
    if (!mesh_) mesh_ = read();
    return mesh_->mesh.triangles.size() >= least_shared_triangles && mesh_->mesh.attributes.empty();
  }
  /// What is shared; `finish` makes it of the file's mesh, in its own coordinates. REQUIRES: is_shared().
  ShapeGroup& group(const std::function<Mesh(MeshFromFile)>& finish) {
    if (!group_) group_.emplace(std::vector<Shape>{Shape{.name = "", .geometry = finish(*mesh_)}});
    if (--uses_ == 0) mesh_.reset();
    return *group_;
  }

 private:
  /// Smaller meshes are copied: an instance costs rays a detour, and about as much memory as ten triangles.
  static constexpr std::size_t least_shared_triangles = 256;

  std::size_t uses_;
  bool can_be_shared_;
  std::optional<MeshFromFile> mesh_;
  std::optional<ShapeGroup> group_;
};

/// A flat quadrilateral of two triangles, counter-clockwise from a, with the unit square as texture
/// coordinates.
void add_quad(Mesh& mesh, const V3f& a, const V3f& b, const V3f& c, const V3f& d) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, b, c, d});
  mesh.uvs.insert(mesh.uvs.end(), {V2f(0, 0), V2f(1, 0), V2f(1, 1), V2f(0, 1)});
  mesh.triangles.emplace_back(first, first + 1, first + 2);
  mesh.triangles.emplace_back(first, first + 2, first + 3);
}

/// To world space, keeping the front where it was: a mirror image needs the opposite winding.
Mesh place(Mesh mesh, Properties& p) {
  const M44d to_world = p.transform("to_world");
  transform(mesh, to_world, p.where("to_world"));
  if (is_mirroring(to_world)) reverse_winding(mesh);
  if (p.boolean("flip_normals", false)) flip(mesh);
  return mesh;
}

Geometry read_rectangle(Properties& p, const MitsubaTree&, ParsedMesh&, Notes&) {
  Mesh mesh;
  add_quad(mesh, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
  return place(std::move(mesh), p);
}

Geometry read_cube(Properties& p, const MitsubaTree&, ParsedMesh&, Notes&) {
  Mesh mesh;
  add_quad(mesh, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1});
  add_quad(mesh, {1, -1, -1}, {-1, -1, -1}, {-1, 1, -1}, {1, 1, -1});
  add_quad(mesh, {1, -1, 1}, {1, -1, -1}, {1, 1, -1}, {1, 1, 1});
  add_quad(mesh, {-1, -1, -1}, {-1, -1, 1}, {-1, 1, 1}, {-1, 1, -1});
  add_quad(mesh, {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1});
  add_quad(mesh, {-1, -1, -1}, {1, -1, -1}, {1, -1, 1}, {-1, -1, 1});
  return place(std::move(mesh), p);
}

Geometry read_sphere(Properties& p, const MitsubaTree&, ParsedMesh&, Notes&) {
  const V3d center = p.point("center", V3d(0.0));
  const double radius = p.number("radius").value_or(1.0);
  if (!(radius > 0.0)) throw Error(p.where("radius"), "a sphere's radius must be positive", "correct it");
  const M44d to_world = p.transform("to_world");
  const double scale = similarity_scale(to_world);
  if (!(scale > 0.0))
    throw Error(p.where("to_world"), "a sphere cannot be scaled differently along its axes",
                "scale it uniformly, or use an OBJ mesh");
  const auto axis = [&](int k) { return V3f(V3d(to_world[k][0], to_world[k][1], to_world[k][2]) / scale); };
  V3d world_center;
  to_world.multVecMatrix(center, world_center);
  const double world_radius = radius * scale;
  if (!(std::abs(world_center.x) <= largest_coordinate && std::abs(world_center.y) <= largest_coordinate &&
        std::abs(world_center.z) <= largest_coordinate && world_radius <= largest_coordinate) ||
      !(static_cast<float>(world_radius) > 0.0f))
    throw Error(p.where("to_world"), "the sphere is too large, too small or too far away", "use other units");
  return Sphere{V3f(world_center),
                static_cast<float>(world_radius),
                p.boolean("flip_normals", false),
                {axis(0), axis(1), axis(2)}};
}

Geometry read_disk(Properties& p, const MitsubaTree&, ParsedMesh&, Notes&) { return read_mitsuba_disk(p); }
Geometry read_cylinder(Properties& p, const MitsubaTree&, ParsedMesh&, Notes&) {
  return read_mitsuba_cylinder(p);
}

/// The file that a shape names.
std::filesystem::path file_of(Properties& p, const MitsubaTree& tree) {
  const std::optional<std::string> name = p.text("filename");
  if (!name)
    throw Error(p.where(), "shape '" + p.type() + "' has no filename",
                "add <string name=\"filename\" value=\"...\"/>");
  return find_file(tree, *p.element("filename", {"string"}), *name);
}

/// What Mitsuba does to every mesh from a file, in its order: without normals in the file they are computed,
/// smooth; face_normals discards both kinds. The winding stays as it comes out of the transform, even mirrored,
/// unless normals say otherwise.
Mesh finish_mesh(Mesh mesh, const M44d& to_world, bool face_normals, bool flipped, Properties& p,
                 Notes& notes) {
  if (face_normals) mesh.normals.clear();
  transform(mesh, to_world, p.where("to_world"));
  if (drop_degenerate_triangles(mesh) > 0)
    notes.add(p.where("filename") + ": triangles without area in '" + p.text("filename").value_or("") +
              "' are left out");
  if (!face_normals && mesh.normals.empty()) compute_smooth_normals(mesh);
  orient_by_normals(mesh);
  drop_flat_normals(mesh);
  if (flipped) flip(mesh);
  return mesh;
}

/// The shape's mesh, or an instance of it where others show the same. Not where the transform mirrors or
/// changes angles: Mitsuba computes normals afterwards.
Geometry mesh_or_instance(ParsedMesh& parsed, const std::function<MeshFromFile()>& read, bool face_normals,
                          Properties& p, Notes& notes) {
  const M44d to_world = p.transform("to_world");
  const bool flipped = p.boolean("flip_normals", false);
  const auto finish = [&](MeshFromFile file, const M44d& transform) {
    return finish_mesh(std::move(file.mesh), transform, face_normals || file.face_normals, flipped, p, notes);
  };
  if (similarity_scale(to_world) > 0.0 && !is_mirroring(to_world) && ShapeGroup::is_placeable(to_world) &&
      parsed.is_shared(read)) {
    ShapeGroup& group = parsed.group([&](MeshFromFile file) { return finish(std::move(file), M44d()); });
    return std::move(group.place(to_world, "", p.where("to_world"), notes).front().geometry);
  }
  return finish(parsed.get(read), to_world);
}

void flip_v(Mesh& mesh) {
  for (V2f& uv : mesh.uvs) uv.y = 1.0f - uv.y;
}

Geometry read_obj_shape(Properties& p, const MitsubaTree& tree, ParsedMesh& parsed, Notes& notes) {
  const std::filesystem::path path = file_of(p, tree);
  const bool face_normals = p.boolean("face_normals", false), flips_v = p.boolean("flip_tex_coords", true);
  p.ignore({"max_smooth_angle", "collapse"});
  const auto read = [&] {
    MeshFromFile file{mesh_of(read_obj(path, notes)), false};
    if (flips_v) flip_v(file.mesh);
    return file;
  };
  return mesh_or_instance(parsed, read, face_normals, p, notes);
}

Geometry read_ply_shape(Properties& p, const MitsubaTree& tree, ParsedMesh& parsed, Notes& notes) {
  const std::filesystem::path path = file_of(p, tree);
  const bool face_normals = p.boolean("face_normals", false), flips_v = p.boolean("flip_tex_coords", false);
  p.ignore({"max_smooth_angle", "srgb"});
  const auto read = [&] {
    MeshFromFile file{read_ply(path, notes), false};
    if (flips_v) flip_v(file.mesh);
    return file;
  };
  return mesh_or_instance(parsed, read, face_normals, p, notes);
}

Geometry read_serialized_shape(Properties& p, const MitsubaTree& tree, ParsedMesh& parsed, Notes& notes) {
  const std::filesystem::path path = file_of(p, tree);
  const bool face_normals = p.boolean("face_normals", false);
  const int index = p.integer("shape_index").value_or(0);
  if (index < 0) throw Error(p.where("shape_index"), "a shape_index is not negative", "the first mesh has 0");
  p.ignore({"max_smooth_angle"});
  const auto read = [&] { return read_serialized(path, index); };
  return mesh_or_instance(parsed, read, face_normals, p, notes);
}

/// Readers of geometry run in parallel: they touch nothing but their arguments.
using Reader = Geometry (*)(Properties&, const MitsubaTree&, ParsedMesh&, Notes&);

constexpr Named<Reader> readers[] = {
    {"cube", read_cube},
    {"cylinder", read_cylinder},
    {"disk", read_disk},
    {"obj", read_obj_shape},
    {"ply", read_ply_shape},
    {"rectangle", read_rectangle},
    {"serialized", read_serialized_shape},
    {"sphere", read_sphere},
    // Read elsewhere; named here for those who misspell them.
    {"shapegroup", nullptr},
    {"instance", nullptr},
};

void read_area_emitter(Shape& shape, const XmlNode& shape_node, const XmlNode& node, const MitsubaTree& tree,
                       MitsubaTextures& textures) {
  constexpr Named<int> supported[] = {{"area", 0}};
  plugin_of_type<int>(supported, node);
  Properties p(node, tree);
  const Texture radiance = textures.property(p, "radiance", ColorUse::emission).value_or(C3f(1.0f));
  shape.radiance[front] = mean_color(radiance);
  if (!is_constant(radiance)) shape.radiance_texture = std::make_shared<const Texture>(radiance);
  p.ignore({"sampling_weight"});
  // One without a name belongs to the lights that have none, not to one called like a number.
  const std::string* id = shape_node.find("id");
  shape.light_group = p.text("light_group").value_or(p.id_or(id ? *id : ""));
  p.finish();
}

/// One shape: what is cheap and touches the whole scene first, its geometry later, on any thread.
class ShapeReader {
 public:
  ShapeReader(const NamedShape& element, const MitsubaTree& tree, MitsubaMaterials& materials,
              MitsubaTextures& textures)
      : node_(*element.node),
        tree_(tree),
        reader_(plugin_of_type<Reader>(readers, node_)),
        properties_(node_, tree) {
    const XmlNode& node = node_;
    if (!element.is_member) properties_.stand_in_world();
    if (!reader_)
      throw Error(node.where(), "a '" + node.get("type") + "' inside of another shape",
                  "instances are not nested: put it beside the others");
    const XmlNode* emitter = properties_.object_of("emitter");
    const XmlNode* bsdf = properties_.object_of("bsdf");
    shape.name = properties_.id_or(element.name);
    shape.material = bsdf ? materials.of(*bsdf) : materials.standard(emitter != nullptr);
    if (emitter) read_area_emitter(shape, node, *emitter, tree, textures);
    properties_.ignore({"silhouette_sampling_weight"});
  }

  void read_geometry(ParsedMesh& parsed) {
    shape.geometry = reader_(properties_, tree_, parsed, notes);
    properties_.finish();
    if (Mesh* mesh = std::get_if<Mesh>(&shape.geometry))
      if (drop_degenerate_triangles(*mesh) > 0)
        notes.add(node_.where() + ": triangles of shape '" + shape.name + "' without area are left out");
  }

  Shape shape;
  Notes notes;

 private:
  const XmlNode& node_;
  const MitsubaTree& tree_;
  Reader reader_;
  Properties properties_;
};

/// Two shapes with the same text here are the same before their transforms; "" where nothing is read from a
/// file. Shapes that cannot be instances stand apart from those that can.
std::string source_of(const XmlNode& node, bool is_instance) {
  std::string source = node.get("type") + '\n' + node.file->string();
  if (!is_instance) source += "\nalone";
  bool has_file = false;
  for (const XmlNode& child : node.children) {
    const std::string* name = child.find("name");
    if (!name || *name == "to_world" || is_object(child) || child.tag == "ref") continue;
    has_file |= *name == "filename";
    source += '\n' + child.tag;
    for (const auto& [attribute, value] : child.attributes) source += '\t' + attribute + '=' + value;
  }
  return has_file ? source : "";
}

/// Indices of shapes by what they are read from, in the order of the first of each.
std::vector<std::vector<std::size_t>> group_by_source(const NamedShapes& elements,
                                                      const std::vector<bool>& can_be_instance) {
  std::vector<std::vector<std::size_t>> groups;
  std::map<std::string, std::size_t> known;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const std::string source = source_of(*elements[i].node, can_be_instance[i]);
    std::size_t group = groups.size();
    if (!source.empty()) group = known.try_emplace(source, group).first->second;
    if (group == groups.size()) groups.emplace_back();
    groups[group].push_back(i);
  }
  return groups;
}

}  // namespace

std::vector<Shape> read_mitsuba_shapes(const NamedShapes& elements, const MitsubaTree& tree,
                                       MitsubaMaterials& materials, MitsubaTextures& textures, Notes& notes) {
  std::vector<ShapeReader> shapes;
  shapes.reserve(elements.size());
  std::vector<bool> can_be_instance;
  for (const NamedShape& element : elements) {
    shapes.emplace_back(element, tree, materials, textures);
    const Shape& shape = shapes.back().shape;
    can_be_instance.push_back(!element.is_member && !is_emitter(shape) && !shape.radiance_texture);
  }
  const auto groups = group_by_source(elements, can_be_instance);
  parallel_tasks(groups.size(), [&](std::size_t g) {
    ParsedMesh parsed(groups[g].size(), can_be_instance[groups[g].front()]);
    for (const std::size_t i : groups[g]) shapes[i].read_geometry(parsed);
  });

  std::vector<Shape> result;
  for (ShapeReader& reader : shapes) {
    notes.add(reader.notes);
    result.push_back(std::move(reader.shape));
  }
  return result;
}

}  // namespace twopass
