#include "render/load/mitsuba_shapes.h"

#include <numeric>

#include "render/core/error.h"
#include "render/load/mesh_tools.h"
#include "render/load/mitsuba_analytic.h"
#include "render/load/mitsuba_properties.h"
#include "render/load/obj_file.h"
#include "render/load/ply_file.h"
#include "render/load/serialized_file.h"
#include "render/load/shape_group.h"

namespace twopass {
namespace {

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

Geometry read_rectangle(Properties& p, const MitsubaTree&, Notes&) {
  Mesh mesh;
  add_quad(mesh, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
  return place(std::move(mesh), p);
}

Geometry read_cube(Properties& p, const MitsubaTree&, Notes&) {
  Mesh mesh;
  add_quad(mesh, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1});
  add_quad(mesh, {1, -1, -1}, {-1, -1, -1}, {-1, 1, -1}, {1, 1, -1});
  add_quad(mesh, {1, -1, 1}, {1, -1, -1}, {1, 1, -1}, {1, 1, 1});
  add_quad(mesh, {-1, -1, -1}, {-1, -1, 1}, {-1, 1, 1}, {-1, 1, -1});
  add_quad(mesh, {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1});
  add_quad(mesh, {-1, -1, -1}, {1, -1, -1}, {1, -1, 1}, {-1, -1, 1});
  return place(std::move(mesh), p);
}

Geometry read_sphere(Properties& p, const MitsubaTree&, Notes&) {
  const V3d center = p.point("center", V3d(0.0));
  const double radius = p.number("radius").value_or(1.0);
  if (!(radius > 0.0)) throw Error(p.where("radius"), "a sphere's radius must be positive", "correct it");
  const M44d to_world = p.transform("to_world");
  const double scale = similarity_scale(to_world);
  if (!(scale > 0.0))
    throw Error(p.where("to_world"), "a sphere cannot be scaled differently along its axes",
                "scale it uniformly, or use an OBJ mesh");
  const auto axis = [&](int k) {
    return V3f(V3d(to_world[k][0], to_world[k][1], to_world[k][2]) / scale);
  };
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

Geometry read_disk(Properties& p, const MitsubaTree&, Notes&) { return read_mitsuba_disk(p); }
Geometry read_cylinder(Properties& p, const MitsubaTree&, Notes&) { return read_mitsuba_cylinder(p); }

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
Geometry finish_mesh(Mesh mesh, bool face_normals, Properties& p, Notes& notes) {
  if (face_normals) mesh.normals.clear();
  transform(mesh, p.transform("to_world"), p.where("to_world"));
  if (drop_degenerate_triangles(mesh) > 0)
    notes.add(p.where("filename") + ": triangles without area in '" + p.text("filename").value_or("") +
              "' are left out");
  if (!face_normals && mesh.normals.empty()) compute_smooth_normals(mesh);
  orient_by_normals(mesh);
  drop_flat_normals(mesh);
  if (p.boolean("flip_normals", false)) flip(mesh);
  return mesh;
}

void flip_v(Mesh& mesh) {
  for (V2f& uv : mesh.uvs) uv.y = 1.0f - uv.y;
}

Geometry read_obj_shape(Properties& p, const MitsubaTree& tree, Notes& notes) {
  const std::filesystem::path path = file_of(p, tree);
  const bool face_normals = p.boolean("face_normals", false), flips_v = p.boolean("flip_tex_coords", true);
  p.ignore({"max_smooth_angle", "collapse"});
  const ObjFile file = read_obj(path, notes);
  std::vector<std::uint32_t> faces(file.faces.size());
  std::iota(faces.begin(), faces.end(), 0u);
  Mesh mesh = mesh_of_faces(file, faces);
  if (flips_v) flip_v(mesh);
  return finish_mesh(std::move(mesh), face_normals, p, notes);
}

Geometry read_ply_shape(Properties& p, const MitsubaTree& tree, Notes& notes) {
  const std::filesystem::path path = file_of(p, tree);
  const bool face_normals = p.boolean("face_normals", false), flips_v = p.boolean("flip_tex_coords", false);
  p.ignore({"max_smooth_angle", "srgb"});
  Mesh mesh = read_ply(path, notes);
  if (flips_v) flip_v(mesh);
  return finish_mesh(std::move(mesh), face_normals, p, notes);
}

Geometry read_serialized_shape(Properties& p, const MitsubaTree& tree, Notes& notes) {
  const std::filesystem::path path = file_of(p, tree);
  const bool face_normals = p.boolean("face_normals", false);
  const int index = p.integer("shape_index").value_or(0);
  if (index < 0) throw Error(p.where("shape_index"), "a shape_index is not negative", "the first mesh has 0");
  p.ignore({"max_smooth_angle"});
  SerializedMesh read = read_serialized(path, index);
  return finish_mesh(std::move(read.mesh), face_normals || read.face_normals, p, notes);
}

using Reader = Geometry (*)(Properties&, const MitsubaTree&, Notes&);

constexpr Named<Reader> readers[] = {
    {"cube", read_cube},           {"cylinder", read_cylinder},
    {"disk", read_disk},           {"obj", read_obj_shape},
    {"ply", read_ply_shape},       {"rectangle", read_rectangle},
    {"serialized", read_serialized_shape}, {"sphere", read_sphere},
    // Read elsewhere; named here for those who misspell them.
    {"shapegroup", nullptr},       {"instance", nullptr},
};

void read_area_emitter(Shape& shape, const XmlNode& node, const MitsubaTree& tree, MitsubaTextures& textures) {
  constexpr Named<int> supported[] = {{"area", 0}};
  plugin_of_type<int>(supported, node);
  Properties p(node, tree);
  const Texture radiance = textures.property(p, "radiance", ColorUse::emission).value_or(C3f(1.0f));
  shape.radiance[front] = mean_color(radiance);
  if (!is_constant(radiance)) shape.radiance_texture = std::make_shared<const Texture>(radiance);
  p.ignore({"sampling_weight"});
  p.finish();
}

}  // namespace

Shape read_mitsuba_shape(const XmlNode& node, const MitsubaTree& tree, const std::string& name,
                         MitsubaMaterials& materials, MitsubaTextures& textures, Notes& notes) {
  const Reader reader = plugin_of_type<Reader>(readers, node);
  if (!reader)
    throw Error(node.where(), "a '" + node.get("type") + "' inside of another shape",
                "instances are not nested: put it beside the others");
  Properties properties(node, tree);
  const XmlNode* emitter = properties.object_of("emitter");
  const XmlNode* bsdf = properties.object_of("bsdf");
  // Cheap things first: a scene full of meshes with an unsupported material should fail before reading them.
  Shape shape;
  shape.name = properties.id_or(name);
  shape.material = bsdf ? materials.of(*bsdf) : materials.standard(emitter != nullptr);
  if (emitter) read_area_emitter(shape, *emitter, tree, textures);
  properties.ignore({"silhouette_sampling_weight"});
  shape.geometry = reader(properties, tree, notes);
  properties.finish();
  if (Mesh* mesh = std::get_if<Mesh>(&shape.geometry))
    if (drop_degenerate_triangles(*mesh) > 0)
      notes.add(node.where() + ": triangles of shape '" + shape.name + "' without area are left out");
  return shape;
}

}  // namespace twopass
