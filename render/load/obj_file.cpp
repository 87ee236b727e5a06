#include "render/load/obj_file.h"

#include <sstream>
#include <unordered_map>

#include <tiny_obj_loader.h>

#include "render/core/error.h"
#include "render/load/mesh_tools.h"
#include "render/load/obj_text.h"
#include "render/load/text_file.h"
#include "render/load/triangulate.h"

namespace twopass {
namespace {

/// Receives tinyobjloader's callbacks: one for each statement of the cleaned text, in its order.
class Receiver {
 public:
  Receiver(const ObjText& text, std::string file_name) : text_(text), name_(std::move(file_name)) {}

  void position(const V3f& p) {
    const std::uint32_t line = next_line();
    for (int axis = 0; axis < 3; ++axis)
      if (!(std::abs(p[axis]) <= largest_coordinate))
        throw Error(where(line), "a coordinate is larger than 1e12", "use larger units");
    file_.positions.push_back(p);
  }
  void normal(const V3f& n) {
    const std::uint32_t line = next_line();
    if (!is_finite(n)) throw Error(where(line), "a normal is too large for a float", "normalise it");
    file_.normals.push_back(n);
  }
  void uv(const V2f& uv) {
    const std::uint32_t line = next_line();
    if (!is_finite(uv)) throw Error(where(line), "a texture coordinate is too large for a float", "correct it");
    file_.uvs.push_back(uv);
  }
  void face(const tinyobj::index_t* indices, int count) {
    ObjFace face{static_cast<std::uint32_t>(file_.corners.size()), static_cast<std::uint32_t>(count), group_,
                 material_, next_line()};
    for (int i = 0; i < count; ++i)
      file_.corners.push_back({absolute(indices[i].vertex_index, file_.positions.size(), face.line),
                               absolute(indices[i].texcoord_index, file_.uvs.size(), face.line),
                               absolute(indices[i].normal_index, file_.normals.size(), face.line)});
    file_.faces.push_back(face);
  }
  void group(const char** names, int count) {
    next_line();
    group_name_.clear();
    for (int i = 0; i < count; ++i) group_name_.append(i > 0 ? " " : "").append(names[i]);
    enter_group();
  }
  void object(const char* name) {
    next_line();
    object_name_ = name;
    group_name_.clear();
    enter_group();
  }
  void material(const char* name) {
    next_line();
    material_ = index_of(name, material_index_, file_.materials);
  }

  /// Positive indices may point forward, so they can only be checked at the end.
  ObjFile finish() {
    for (const ObjFace& face : file_.faces)
      for (std::uint32_t i = 0; i < face.corner_count; ++i) {
        const ObjCorner& corner = file_.corners[face.first_corner + i];
        check(corner.position, file_.positions.size(), "position", face.line);
        if (corner.uv != no_obj_index) check(corner.uv, file_.uvs.size(), "texture coordinate", face.line);
        if (corner.normal != no_obj_index) check(corner.normal, file_.normals.size(), "normal", face.line);
      }
    if (file_.faces.empty())
      throw Error(name_, "there is no face in this file", "give an OBJ file with polygons");
    file_.libraries = text_.libraries;
    file_.smoothing = text_.smoothing;
    return std::move(file_);
  }

 private:
  using Names = std::unordered_map<std::string, std::uint32_t>;

  std::uint32_t next_line() { return text_.lines[statement_++]; }
  [[nodiscard]] std::string where(std::uint32_t line) const { return name_ + ":" + std::to_string(line); }

  [[nodiscard]] std::uint32_t absolute(int index, std::size_t count, std::uint32_t line) const {
    if (index == 0) return no_obj_index;  // tinyobjloader's word for "none"; the text holds no zeros
    if (index > 0) return static_cast<std::uint32_t>(index - 1);
    if (static_cast<std::size_t>(-static_cast<long long>(index)) > count)
      throw Error(where(line),
                  "index " + std::to_string(index) + " points before the first of " + std::to_string(count),
                  "correct the face");
    return static_cast<std::uint32_t>(static_cast<long long>(count) + index);
  }
  void check(std::uint32_t index, std::size_t count, std::string_view kind, std::uint32_t line) const {
    if (index >= count)
      throw Error(where(line),
                  std::string(kind) + " " + std::to_string(index + 1ull) + " does not exist: there are " +
                      std::to_string(count),
                  "correct the face");
  }

  static std::uint32_t index_of(const std::string& name, Names& known, std::vector<std::string>& list) {
    const auto [entry, is_new] = known.try_emplace(name, static_cast<std::uint32_t>(list.size()));
    if (is_new) list.push_back(name);
    return entry->second;
  }
  void enter_group() {
    std::string name = object_name_;
    if (!name.empty() && !group_name_.empty()) name += '/';
    group_ = index_of(name + group_name_, group_index_, file_.groups);
  }

  const ObjText& text_;
  std::string name_;
  ObjFile file_;
  std::size_t statement_ = 0;
  std::string object_name_, group_name_;
  std::uint32_t group_ = 0, material_ = 0;
  Names group_index_{{"", 0}}, material_index_{{"", 0}};
};

tinyobj::callback_t callbacks() {
  tinyobj::callback_t call;
  call.vertex_cb = [](void* to, float x, float y, float z, float) {
    static_cast<Receiver*>(to)->position({x, y, z});
  };
  call.normal_cb = [](void* to, float x, float y, float z) { static_cast<Receiver*>(to)->normal({x, y, z}); };
  call.texcoord_cb = [](void* to, float x, float y, float) { static_cast<Receiver*>(to)->uv({x, y}); };
  call.index_cb = [](void* to, tinyobj::index_t* i, int n) { static_cast<Receiver*>(to)->face(i, n); };
  call.group_cb = [](void* to, const char** names, int n) { static_cast<Receiver*>(to)->group(names, n); };
  call.object_cb = [](void* to, const char* name) { static_cast<Receiver*>(to)->object(name); };
  call.usemtl_cb = [](void* to, const char* name, int) { static_cast<Receiver*>(to)->material(name); };
  return call;
}

struct CornerHash {
  std::size_t operator()(const ObjCorner& c) const {
    std::uint64_t h = c.position;
    for (const std::uint64_t more : {c.uv, c.normal}) h = (h ^ more) * 0x9e3779b97f4a7c15ull + (h >> 29);
    return h ^ (h >> 32);
  }
};
struct CornerEqual {
  bool operator()(const ObjCorner& a, const ObjCorner& b) const {
    return a.position == b.position && a.uv == b.uv && a.normal == b.normal;
  }
};

/// Mean normal of a polygon; zero when it has no area.
V3f face_normal(std::span<const V3f> corners) {
  V3d sum(0.0);
  const V3d origin(corners[0]);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum += (V3d(corners[i]) - origin).cross(V3d(corners[i + 1]) - origin);
  return V3f(sum.normalized());
}

bool has_normal(const ObjFile& file, const ObjCorner& corner) {
  return corner.normal != no_obj_index && file.normals[corner.normal].length() > 0.0f;
}

}  // namespace

ObjFile read_obj(const std::filesystem::path& path, Notes& notes) {
  const ObjText text = clean_obj(read_text_file(path), path.string(), notes);
  Receiver receiver(text, path.string());
  std::istringstream stream(text.text);
  tinyobj::LoadObjWithCallback(stream, callbacks(), &receiver);
  return receiver.finish();
}

Mesh mesh_of_faces(const ObjFile& file, const std::vector<std::uint32_t>& faces) {
  bool any_normal = false, any_uv = false;
  std::size_t corner_count = 0;
  for (const std::uint32_t f : faces) {
    const ObjFace& face = file.faces[f];
    corner_count += face.corner_count;
    for (std::uint32_t i = 0; i < face.corner_count; ++i) {
      const ObjCorner& corner = file.corners[face.first_corner + i];
      any_normal |= has_normal(file, corner);
      any_uv |= corner.uv != no_obj_index;
    }
  }

  Mesh mesh;
  std::unordered_map<ObjCorner, std::uint32_t, CornerHash, CornerEqual> known;
  known.reserve(corner_count);
  std::vector<V3f> points;
  std::vector<std::uint32_t> vertices;
  for (const std::uint32_t f : faces) {
    const ObjFace& face = file.faces[f];
    points.clear();
    vertices.clear();
    for (std::uint32_t i = 0; i < face.corner_count; ++i)
      points.push_back(file.positions[file.corners[face.first_corner + i].position]);
    for (std::uint32_t i = 0; i < face.corner_count; ++i) {
      ObjCorner key = file.corners[face.first_corner + i];
      const bool own_normal = has_normal(file, key);
      // A face's own normal is nobody else's: numbered from the far end, clear of the file's normals.
      if (!any_normal)
        key.normal = no_obj_index;
      else if (!own_normal)
        key.normal = no_obj_index - 1 - f;
      const auto [entry, is_new] = known.try_emplace(key, static_cast<std::uint32_t>(mesh.positions.size()));
      vertices.push_back(entry->second);
      if (!is_new) continue;
      mesh.positions.push_back(points[i]);
      if (any_normal)
        mesh.normals.push_back(own_normal ? file.normals[key.normal].normalized() : face_normal(points));
      if (any_uv) mesh.uvs.push_back(key.uv == no_obj_index ? V2f(0.0f) : file.uvs[key.uv]);
    }
    for (const auto& [a, b, c] : triangulate(points))
      mesh.triangles.emplace_back(vertices[a], vertices[b], vertices[c]);
  }
  return mesh;
}

}  // namespace twopass
