#include "render/load/load_obj_scene.h"

#include <algorithm>
#include <set>

#include "render/core/error.h"
#include "render/core/parallel.h"
#include "render/image/regular_file.h"
#include "render/load/mesh_tools.h"
#include "render/load/mtl_material.h"
#include "render/load/number.h"
#include "render/load/obj_mesh.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

/// The files that a mtllib line names: one name with blanks in it, or several names. What leads nowhere is
/// noted.
std::vector<std::filesystem::path> library_paths(const std::string& line, const std::filesystem::path& obj,
                                                 Notes& notes) {
  const std::filesystem::path folder = obj.parent_path();
  if (const auto whole = find_any_case(folder / line)) return {*whole};
  std::vector<std::filesystem::path> paths;
  std::vector<std::string> lost;
  for (const std::string_view name : split(line, " \t"))
    if (const auto path = find_any_case(folder / name))
      paths.push_back(*path);
    else
      lost.emplace_back(name);
  if (paths.empty()) lost = {line};
  for (const std::string& name : lost)
    notes.add(obj.string() + ": its material library " + in_quotes(name) + " does not exist");
  return paths;
}

/// The materials that the file uses, from its libraries; the first definition of a name counts.
MtlLibrary read_libraries(const ObjFile& file, const std::filesystem::path& path, TextureFiles& textures,
                          Notes& notes) {
  MtlLibrary library;
  std::vector<bool> is_used(file.materials.size(), false);
  for (const ObjFace& face : file.faces) is_used[face.material] = true;
  std::set<std::string> missing;
  for (std::size_t i = 1; i < is_used.size(); ++i)  // the first is that of faces without one
    if (is_used[i]) missing.insert(file.materials[i]);
  std::set<std::filesystem::path> read;
  const auto add = [&](const std::filesystem::path& mtl) {
    if (!read.insert(mtl).second) return;
    library.merge(read_mtl(mtl, missing, textures, notes));
    std::erase_if(missing, [&](const std::string& name) { return library.contains(name); });
  };
  for (const std::string& line : file.libraries)
    for (const std::filesystem::path& mtl : library_paths(line, path, notes)) add(mtl);
  // Exporters that rename an OBJ forget the mtllib line: the library beside it may have what is missing.
  std::filesystem::path beside = path;
  beside.replace_extension(".mtl");
  if (const auto found = find_any_case(beside); found && !missing.empty() && !read.contains(*found)) {
    const std::size_t before = missing.size();
    add(*found);
    if (missing.size() < before)
      notes.add(path.string() + ": materials that its libraries lack are taken from " + found->string());
  }
  return library;
}

/// Faces of one group and one material.
struct Part {
  std::uint32_t group, material;
  std::vector<FaceRange> faces;
  Mesh mesh{};
  std::size_t dropped = 0, reversed = 0;  ///< triangles without area; that faced away from their normals
};

/// The parts in the order of their first faces.
std::vector<Part> split_into_parts(const ObjFile& file) {
  std::vector<Part> parts;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> known;
  const auto is_of = [&](const ObjFace& face, const Part& part) {
    return face.group == part.group && face.material == part.material;
  };
  for (std::uint32_t f = 0; f < file.faces.size();) {
    const ObjFace& face = file.faces[f];
    const auto [entry, is_new] = known.try_emplace({face.group, face.material}, parts.size());
    if (is_new) parts.push_back({.group = face.group, .material = face.material, .faces = {}});
    Part& part = parts[entry->second];
    FaceRange range{f, f + 1};
    while (range.end < file.faces.size() && is_of(file.faces[range.end], part)) ++range.end;
    part.faces.push_back(range);
    f = range.end;
  }
  return parts;
}

void make_mesh(const ObjFile& file, Part& part) {
  part.mesh = mesh_of_faces(file, part.faces);
  part.dropped = drop_degenerate_triangles(part.mesh);
  part.reversed = orient_by_normals(part.mesh);
  drop_flat_normals(part.mesh);
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
      shape.radiance_texture = found->second.radiance_texture;
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

LoadedScene load_obj_scene(const std::filesystem::path& path, const TextureOptions& texture_options) {
  LoadedScene loaded;
  Notes notes;
  TextureFiles textures(texture_options);
  ObjFile file = read_obj(path, notes);
  add_smooth_normals(file);
  MaterialTable materials(file, read_libraries(file, path, textures, notes), path.string(), loaded.scene,
                          notes);
  std::vector<Part> parts = split_into_parts(file);
  parallel_tasks(parts.size(), [&](std::size_t i) { make_mesh(file, parts[i]); });

  std::vector<std::size_t> parts_in_group(file.groups.size(), 0);
  for (const Part& part : parts) ++parts_in_group[part.group];
  std::size_t dropped = 0, reversed = 0;
  for (Part& part : parts) {
    dropped += part.dropped;
    reversed += part.reversed;
    if (part.mesh.triangles.empty()) continue;
    Shape shape;
    shape.name = name_of_part(file, part, parts_in_group[part.group], path);
    shape.geometry = std::move(part.mesh);
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
  textures.report(notes);
  loaded.tiled_textures = textures.tiled();
  loaded.notes = notes.lines();
  return loaded;
}

}  // namespace twopass
