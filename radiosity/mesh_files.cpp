#include "radiosity/mesh_files.h"

#include <cstring>

#include <nlohmann/json.hpp>

#include "render/core/error.h"
#include "render/image/atomic_file.h"
#include "render/image/srgb.h"

namespace twopass {

namespace {

using nlohmann::ordered_json;

class Bytes {
 public:
  template <class T>
  void add(const T& value) {
    const auto* begin = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), begin, begin + sizeof value);
  }
  template <class T>
  void add_all(const std::vector<T>& list) {
    const auto* begin = reinterpret_cast<const std::byte*>(list.data());
    bytes_.insert(bytes_.end(), begin, begin + list.size() * sizeof(T));
  }
  void add_text(std::string_view text) {
    for (const char c : text) bytes_.push_back(static_cast<std::byte>(c));
  }
  void pad(std::size_t multiple, char with) {
    while (bytes_.size() % multiple != 0) bytes_.push_back(static_cast<std::byte>(with));
  }
  [[nodiscard]] const std::vector<std::byte>& all() const { return bytes_; }
  [[nodiscard]] std::vector<std::byte> take() && { return std::move(bytes_); }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }

 private:
  std::vector<std::byte> bytes_;
};

std::uint8_t srgb_byte(float linear) {
  return static_cast<std::uint8_t>(std::lround(255.0f * srgb_encode(linear)));
}

// The numbers of glTF's enumerations.
constexpr int gltf_float = 5126, gltf_unsigned_int = 5125, gltf_array_buffer = 34962,
              gltf_element_array_buffer = 34963;

// The three parts of the binary chunk; accessors point into them.
struct Buffers {
  Bytes positions, colors, indices;
};

ordered_json vector_json(const V3f& v) { return {v.x, v.y, v.z}; }

// Adds the side's data, and returns the primitive that shows it.
ordered_json add_primitive(const DisplaySide& side, Buffers& buffers, ordered_json& accessors) {
  Box3f box;
  for (const V3f& p : side.position) box.extendBy(p);
  const std::size_t first = accessors.size();
  accessors.push_back({{"bufferView", 0},
                       {"byteOffset", buffers.positions.size()},
                       {"componentType", gltf_float},
                       {"count", side.position.size()},
                       {"type", "VEC3"},
                       {"min", vector_json(box.min)},
                       {"max", vector_json(box.max)}});
  accessors.push_back({{"bufferView", 1},
                       {"byteOffset", buffers.colors.size()},
                       {"componentType", gltf_float},
                       {"count", side.color.size()},
                       {"type", "VEC3"}});
  accessors.push_back({{"bufferView", 2},
                       {"byteOffset", buffers.indices.size()},
                       {"componentType", gltf_unsigned_int},
                       {"count", 3 * side.triangle.size()},
                       {"type", "SCALAR"}});
  buffers.positions.add_all(side.position);
  buffers.colors.add_all(side.color);
  buffers.indices.add_all(side.triangle);
  return {
      {"attributes", {{"POSITION", first}, {"COLOR_0", first + 1}}}, {"indices", first + 2}, {"material", 0}};
}

ordered_json buffer_views(const Buffers& buffers) {
  const std::size_t positions = buffers.positions.size(), colors = buffers.colors.size();
  return {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", positions}, {"target", gltf_array_buffer}},
          {{"buffer", 0}, {"byteOffset", positions}, {"byteLength", colors}, {"target", gltf_array_buffer}},
          {{"buffer", 0},
           {"byteOffset", positions + colors},
           {"byteLength", buffers.indices.size()},
           {"target", gltf_element_array_buffer}}};
}

// All but what is made of the meshes: an empty scene has no buffers, which glTF forbids to be empty.
ordered_json gltf_json(double exposure) {
  const ordered_json material = {{"name", "radiosity"},
                                 {"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 1.0}}},
                                 {"extensions", {{"KHR_materials_unlit", ordered_json::object()}}}};
  const ordered_json extras = {{"exposure", exposure}, {"color", "exposure x radiance, W/(m2 sr)"}};
  return {{"asset", {{"version", "2.0"}, {"generator", "twopass"}, {"extras", extras}}},
          {"extensionsUsed", ordered_json::array({"KHR_materials_unlit"})},
          {"materials", ordered_json::array({material})}};
}

// glTF's cameras look down their -z axis, +x to the right; ours down +z, +x to the left.
std::optional<M44d> gltf_matrix(const CameraDescription& camera) {
  if (camera.projection != Projection::perspective) return std::nullopt;
  M44d half_turn;
  half_turn[0][0] = half_turn[2][2] = -1.0;
  const M44d to_world = half_turn * camera.to_world;
  return to_world.determinant() > 0.0 ? std::optional(to_world) : std::nullopt;
}

// Row vectors, row by row, are column vectors, column by column.
ordered_json matrix_json(const M44d& matrix) {
  ordered_json numbers = ordered_json::array();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) numbers.push_back(matrix[row][column]);
  return numbers;
}

// A near plane that depth buffers can bear, of a camera anywhere in the scene.
double near_of(const DisplayMesh& mesh) {
  Box3f box;
  for (const DisplaySide& side : mesh.sides)
    for (const V3f& p : side.position) box.extendBy(p);
  return box.isEmpty() ? 1e-3 : std::max(1e-3 * static_cast<double>(box.size().length()), 1e-30);
}

void add_meshes(ordered_json& gltf, const DisplayMesh& mesh, const Scene& scene, Buffers& buffers) {
  ordered_json nodes = ordered_json::array(), meshes = ordered_json::array(), accessors = ordered_json::array(),
               roots = ordered_json::array();
  for (std::size_t begin = 0, end = 0; begin < mesh.sides.size(); begin = end) {
    ordered_json primitives = ordered_json::array();
    for (; end < mesh.sides.size() && mesh.sides[end].shape == mesh.sides[begin].shape; ++end)
      if (!mesh.sides[end].triangle.empty())
        primitives.push_back(add_primitive(mesh.sides[end], buffers, accessors));
    if (primitives.empty()) continue;
    const std::string& name = scene.shapes()[mesh.sides[begin].shape].name;
    roots.push_back(nodes.size());
    nodes.push_back({{"name", name}, {"mesh", meshes.size()}});
    meshes.push_back({{"name", name}, {"primitives", primitives}});
  }
  if (const std::optional<CameraDescription>& camera = scene.description().camera)
    if (const std::optional<M44d> to_world = gltf_matrix(scene.description().frame.to_world(*camera))) {
      roots.push_back(nodes.size());
      nodes.push_back({{"name", "camera"}, {"camera", 0}, {"matrix", matrix_json(*to_world)}});
      const double yfov = camera->fov_degrees * pi / 180.0;
      gltf["cameras"] = ordered_json::array(
          {{{"type", "perspective"}, {"perspective", {{"yfov", yfov}, {"znear", near_of(mesh)}}}}});
    }
  gltf["scene"] = 0;
  if (nodes.empty()) {
    gltf["scenes"] = ordered_json::array({ordered_json::object()});
    return;
  }
  gltf["scenes"] = ordered_json::array({ordered_json{{"nodes", roots}}});
  gltf["nodes"] = nodes;
  if (meshes.empty()) return;
  gltf["meshes"] = meshes;
  gltf["accessors"] = accessors;
  gltf["bufferViews"] = buffer_views(buffers);
  const std::size_t bytes = buffers.positions.size() + buffers.colors.size() + buffers.indices.size();
  gltf["buffers"] = ordered_json::array({ordered_json{{"byteLength", bytes}}});
}

}  // namespace

void write_ply(const std::filesystem::path& path, const DisplayMesh& mesh) {
  std::size_t vertices = 0, triangles = 0;
  for (const DisplaySide& side : mesh.sides) {
    vertices += side.position.size();
    triangles += side.triangle.size();
  }
  char header[640];
  const int length =
      std::snprintf(header, sizeof header,
                    "ply\nformat binary_little_endian 1.0\ncomment twopass: radiosity as colours\n"
                    "comment colour = sRGB(exposure x radiance), radiance in W/(m2 sr)\ncomment exposure %.9g\n"
                    "element vertex %zu\nproperty float x\nproperty float y\nproperty float z\n"
                    "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                    "element face %zu\nproperty list uchar int vertex_indices\nend_header\n",
                    mesh.exposure, vertices, triangles);
  if (vertices > 0x7fffffffu)
    throw Error(path.string(), "more vertices than PLY can number", "solve with fewer --elements");
  Bytes bytes;
  bytes.add_text({header, static_cast<std::size_t>(length)});
  for (const DisplaySide& side : mesh.sides)
    for (std::size_t k = 0; k < side.position.size(); ++k) {
      bytes.add(side.position[k]);
      for (int c = 0; c < 3; ++c) bytes.add(srgb_byte(side.color[k][c]));
    }
  std::uint32_t first = 0;
  for (const DisplaySide& side : mesh.sides) {
    for (const V3u& t : side.triangle) {
      bytes.add(std::uint8_t{3});
      for (int c = 0; c < 3; ++c) bytes.add(first + t[c]);
    }
    first += static_cast<std::uint32_t>(side.position.size());
  }
  write_atomically(path, bytes.all());
}

std::vector<std::byte> glb_of(const DisplayMesh& mesh, const Scene& scene, std::string_view where) {
  Buffers buffers;
  ordered_json gltf = gltf_json(mesh.exposure);
  add_meshes(gltf, mesh, scene, buffers);
  Bytes json;
  json.add_text(gltf.dump(-1, ' ', false, ordered_json::error_handler_t::replace));
  json.pad(4, ' ');
  // The chunk's three parts are made of numbers of 4 bytes: nothing is left to align.
  const std::size_t binary = buffers.positions.size() + buffers.colors.size() + buffers.indices.size();
  const std::size_t total = 12 + 8 + json.size() + (binary > 0 ? 8 + binary : 0);
  if (total > 0xffffffffu)
    throw Error(std::string(where), "more than the 4 GB that glTF can hold", "solve with fewer --elements");
  Bytes bytes;
  bytes.add_text("glTF");
  bytes.add(std::uint32_t{2});
  bytes.add(static_cast<std::uint32_t>(total));
  bytes.add(static_cast<std::uint32_t>(json.size()));
  bytes.add_text("JSON");
  bytes.add_all(json.all());
  if (binary > 0) {
    bytes.add(static_cast<std::uint32_t>(binary));
    bytes.add_text({"BIN\0", 4});
    for (const Bytes* part : {&buffers.positions, &buffers.colors, &buffers.indices})
      bytes.add_all(part->all());
  }
  return std::move(bytes).take();
}

void write_glb(const std::filesystem::path& path, const DisplayMesh& mesh, const Scene& scene) {
  write_atomically(path, glb_of(mesh, scene, path.string()));
}

}  // namespace twopass
