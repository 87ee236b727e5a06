#include "render/load/load_obj_scene.h"

#include <algorithm>
#include <set>

#include "render/core/error.h"
#include "render/load/mesh_tools.h"
#include "render/load/mtl_material.h"
#include "render/load/number.h"
#include "render/load/obj_file.h"

namespace twopass {
namespace {

bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

/// The files that a mtllib line names: one name with spaces in it, or several names. Names that lead nowhere
/// are kept, to be complained of.
std::vector<std::filesystem::path> library_paths(std::string line, const std::filesystem::path& folder) {
  std::ranges::replace(line, '\\', '/');
  if (is_there(folder / line)) return {folder / line};
  std::vector<std::filesystem::path> paths;
  for (const std::string_view name : split(line, " \t")) paths.push_back(folder / name);
  return paths;
}

/// The materials that the file uses, from its libraries; the first definition of a name counts.
MtlLibrary read_libraries(const ObjFile& file, const std::filesystem::path& path, Notes& notes) {
  MtlLibrary library;
  std::set<std::string> missing;
  for (const ObjFace& face : file.faces) missing.insert(file.materials[face.material]);
  missing.erase("");
  std::set<std::filesystem::path> read;
  const auto add = [&](const std::filesystem::path& mtl) {
    if (!read.insert(mtl).second) return;
    library.merge(read_mtl(mtl, missing, notes));
    std::erase_if(missing, [&](const std::string& name) { return library.contains(name); });
  };
  for (const std::string& line : file.libraries)
    for (const std::filesystem::path& mtl : library_paths(line, path.parent_path())) {
      if (is_there(mtl))
        add(mtl);
      else
        notes.add(path.string() + ": its material library " + mtl.string() + " does not exist");
    }
  // Exporters that rename an OBJ forget the mtllib line: the library beside it may have what is missing.
  std::filesystem::path beside = path;
  beside.replace_extension(".mtl");
  if (!missing.empty() && is_there(beside) && !read.contains(beside)) {
    const std::size_t before = missing.size();
    add(beside);
    if (missing.size() < before)
      notes.add(path.string() + ": materials that its libraries lack are taken from " + beside.string());
  }
  return library;
}

/// Faces of one group and one material.
struct Part {
  std::uint32_t group, material;
  std::vector<std::uint32_t> faces;
};

/// The parts in the order of their first faces.
std::vector<Part> split_into_parts(const ObjFile& file) {
  std::vector<Part> parts;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> known;
  for (std::uint32_t f = 0; f < file.faces.size(); ++f) {
    const ObjFace& face = file.faces[f];
    const auto [entry, is_new] = known.try_emplace({face.group, face.material}, parts.size());
    if (is_new) parts.push_back({face.group, face.material, {}});
    parts[entry->second].faces.push_back(f);
  }
  return parts;
}

std::string name_of_part(const ObjFile& file, const Part& part, std::size_t parts_in_group,
                         const std::filesystem::path& path) {
  const std::string &group = file.groups[part.group], &material = file.materials[part.material];
  if (group.empty()) return material.empty() ? path.stem().string() : material;
  return parts_in_group > 1 && !material.empty() ? group + ":" + material : group;
}

/// Our materials for the names that the file uses, made as they are asked for.
class MaterialTable {
 public:
  MaterialTable(const ObjFile& file, MtlLibrary library, std::string where, SceneDescription& scene,
                Notes& notes)
      : file_(file), library_(std::move(library)), where_(std::move(where)), scene_(scene), notes_(notes) {}

  /// Assigns the material called file.materials[name] and its emission to the shape.
  void assign(std::uint32_t name, Shape& shape) {
    const auto [entry, is_new] = index_.try_emplace(name, static_cast<std::uint32_t>(scene_.materials.size()));
    shape.material = entry->second;
    const std::string& material = file_.materials[name];
    const auto found = library_.find(material);
    if (found != library_.end()) {
      shape.radiance[front] = found->second.radiance;
      if (is_new) scene_.materials.push_back(found->second.material);
      return;
    }
    if (!is_new) return;
    const Diffuse grey{C3f(0.5f)};
    scene_.materials.push_back(two_sided(material.empty() ? "default" : material, grey, grey));
    notes_.add(where_ + (material.empty() ? ": faces without usemtl are grey (0.5)"
                                          : ": material '" + material + "' is not defined: grey (0.5)"));
  }

 private:
  const ObjFile& file_;
  MtlLibrary library_;
  std::string where_;
  SceneDescription& scene_;
  Notes& notes_;
  std::map<std::uint32_t, std::uint32_t> index_;
};

}  // namespace

LoadedScene load_obj_scene(const std::filesystem::path& path) {
  LoadedScene loaded;
  Notes notes;
  const ObjFile file = read_obj(path, notes);
  MaterialTable materials(file, read_libraries(file, path, notes), path.string(), loaded.scene, notes);
  const std::vector<Part> parts = split_into_parts(file);
  std::vector<std::size_t> parts_in_group(file.groups.size(), 0);
  for (const Part& part : parts) ++parts_in_group[part.group];
  std::size_t dropped = 0, reversed = 0;
  bool flat = false;
  for (const Part& part : parts) {
    Mesh mesh = mesh_of_faces(file, part.faces);
    flat |= mesh.normals.empty();
    dropped += drop_degenerate_triangles(mesh);
    if (mesh.triangles.empty()) continue;
    reversed += orient_by_normals(mesh);
    drop_flat_normals(mesh);
    Shape shape;
    shape.name = name_of_part(file, part, parts_in_group[part.group], path);
    shape.geometry = std::move(mesh);
    materials.assign(part.material, shape);
    loaded.scene.shapes.push_back(std::move(shape));
  }
  if (loaded.scene.shapes.empty())
    throw Error(path.string(), "none of its triangles has an area", "give an OBJ file with polygons");
  if (dropped > 0)
    notes.add(path.string() + ": " + std::to_string(dropped) + " triangles without area are left out");
  if (reversed > 0)
    notes.add(path.string() + ": " + std::to_string(reversed) +
              " triangles faced away from their own normals and were turned");
  if (flat && file.smoothing)
    notes.add(path.string() + ": smoothing groups are not read: faces without normals are flat");
  loaded.notes = notes.lines();
  return loaded;
}

}  // namespace twopass
