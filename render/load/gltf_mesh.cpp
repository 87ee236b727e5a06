#include "render/load/gltf_mesh.h"

#include <algorithm>
#include <numeric>

#include "render/core/error.h"
#include "render/load/gltf_accessor.h"
#include "render/load/mesh_tools.h"

namespace twopass {
namespace {

/// Triangles over the corners 0 to count - 1 of a list, strip or fan (specification, section 3.7.2.1).
std::vector<V3u> triangles_of(int mode, std::uint32_t count) {
  std::vector<V3u> triangles;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    triangles.reserve(count / 3);
    for (std::uint32_t i = 0; i + 2 < count; i += 3) triangles.emplace_back(i, i + 1, i + 2);
  } else {
    const bool is_fan = mode == TINYGLTF_MODE_TRIANGLE_FAN;
    for (std::uint32_t i = 0; i + 2 < count; ++i)
      triangles.push_back(is_fan ? V3u(i + 1, i + 2, 0) : V3u(i, i + 1 + i % 2, i + 2 - i % 2));
  }
  return triangles;
}

/// Reads the attributes of a primitive, which all have as many elements.
class AttributeReader {
 public:
  AttributeReader(const GltfDocument& document, const tinygltf::Primitive& primitive, const std::string& mesh)
      : document_(document), primitive_(primitive), mesh_(mesh) {}

  /// Nothing when the primitive has no such attribute.
  [[nodiscard]] std::optional<GltfAccessor> find(const std::string& attribute, int least, int most) const {
    const auto found = primitive_.attributes.find(attribute);
    if (found == primitive_.attributes.end()) return std::nullopt;
    GltfAccessor accessor(document_, found->second, attribute + " of mesh '" + mesh_ + "'");
    if (accessor.components() < least || accessor.components() > most)
      throw Error(document_.file,
                  accessor.name() + " has elements of " + std::to_string(accessor.components()) + " numbers",
                  "correct the file");
    return accessor;
  }
  [[nodiscard]] std::optional<GltfAccessor> find(const std::string& attribute, int least, int most,
                                                 std::size_t count) const {
    std::optional<GltfAccessor> accessor = find(attribute, least, most);
    if (accessor && accessor->count() != count)
      throw Error(document_.file,
                  accessor->name() + " has " + std::to_string(accessor->count()) + " elements for " +
                      std::to_string(count) + " positions",
                  "correct the file");
    return accessor;
  }

 private:
  const GltfDocument& document_;
  const tinygltf::Primitive& primitive_;
  const std::string& mesh_;
};

/// The vertices of the corners that the primitive lists.
std::vector<std::uint32_t> read_corners(const GltfDocument& document, const tinygltf::Primitive& primitive,
                                        const std::string& mesh, std::size_t vertices) {
  std::vector<std::uint32_t> corners;
  if (primitive.indices < 0) {
    if (vertices > 0xffffffffu)
      throw Error(document.file, "mesh '" + mesh + "' has more vertices than can be numbered", "split it");
    corners.resize(vertices);
    std::iota(corners.begin(), corners.end(), 0u);
    return corners;
  }
  const GltfAccessor indices(document, primitive.indices, "indices of mesh '" + mesh + "'");
  if (!indices.is_index())
    throw Error(document.file, indices.name() + " does not hold unsigned integers", "correct the file");
  if (indices.count() > 0xffffffffu)
    throw Error(document.file, indices.name() + " has more elements than can be numbered", "split the mesh");
  corners.resize(indices.count());
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = indices.index(i);
  return corners;
}

V3f vector_of(const GltfAccessor& accessor, std::size_t i) {
  return {accessor.number(i, 0), accessor.number(i, 1), accessor.number(i, 2)};
}

bool is_usable(const V3f& p) {
  return is_finite(p) && max_abs_component(p) <= static_cast<float>(largest_coordinate);
}

/// Triangles over vertices, without those that are not worth having.
std::vector<V3u> usable_triangles(int mode, const std::vector<std::uint32_t>& corners,
                                  const GltfAccessor& positions, GltfLosses& losses) {
  std::vector<V3u> triangles = triangles_of(mode, static_cast<std::uint32_t>(corners.size()));
  for (V3u& t : triangles) t = V3u(corners[t.x], corners[t.y], corners[t.z]);
  losses.bad_indices += std::erase_if(triangles, [&](const V3u& t) {
    return t.x >= positions.count() || t.y >= positions.count() || t.z >= positions.count();
  });
  losses.not_finite += std::erase_if(triangles, [&](const V3u& t) {
    return !is_usable(vector_of(positions, t.x)) || !is_usable(vector_of(positions, t.y)) ||
           !is_usable(vector_of(positions, t.z));
  });
  losses.without_area += std::erase_if(triangles, [&](const V3u& t) {
    const V3d a(vector_of(positions, t.x)), b(vector_of(positions, t.y)), c(vector_of(positions, t.z));
    return !((b - a).cross(c - a).length() > 0.0);
  });
  return triangles;
}

/// Numbers the vertices that triangles use anew; returns their old numbers, ascending.
std::vector<std::uint32_t> renumber(std::vector<V3u>& triangles) {
  std::vector<std::uint32_t> used;
  used.reserve(3 * triangles.size());
  for (const V3u& t : triangles) used.insert(used.end(), {t.x, t.y, t.z});
  std::ranges::sort(used);
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const auto number = [&](std::uint32_t vertex) {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(used, vertex) - used.begin());
  };
  for (V3u& t : triangles) t = V3u(number(t.x), number(t.y), number(t.z));
  return used;
}

float in_unit_range(float x) { return x >= 0.0f ? std::min(x, 1.0f) : 0.0f; }  // NaN: 0

void read_colors(const GltfAccessor& colors, const std::vector<std::uint32_t>& used, GltfPrimitive& result) {
  for (const std::uint32_t i : used) {
    const V3f color = vector_of(colors, i);
    result.colors.emplace_back(in_unit_range(color.x), in_unit_range(color.y), in_unit_range(color.z));
    if (colors.components() == 4) result.alphas.push_back(in_unit_range(colors.number(i, 3)));
  }
}

}  // namespace

std::optional<GltfPrimitive> read_gltf_primitive(const GltfDocument& document,
                                                 const tinygltf::Primitive& primitive, const std::string& name,
                                                 GltfLosses& losses) {
  if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
    ++losses.not_triangles;
    return std::nullopt;
  }
  if (primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
    throw Error(document.file, "mesh '" + name + "' has a primitive of mode " + std::to_string(primitive.mode),
                "modes are 0 to 6: correct the file");
  const AttributeReader attributes(document, primitive, name);
  const std::optional<GltfAccessor> positions = attributes.find("POSITION", 3, 3);
  if (!positions) return std::nullopt;  // section 3.7.2.1: nothing to draw
  const std::size_t count = positions->count();
  if (!primitive.targets.empty()) ++losses.morph_targets;

  GltfPrimitive result;
  Mesh& mesh = result.mesh;
  const std::vector<std::uint32_t> corners = read_corners(document, primitive, name, count);
  losses.corners += corners.size();
  mesh.triangles = usable_triangles(primitive.mode, corners, *positions, losses);
  if (mesh.triangles.empty()) return std::nullopt;
  const std::vector<std::uint32_t> used = renumber(mesh.triangles);
  mesh.positions.reserve(used.size());
  for (const std::uint32_t i : used) mesh.positions.push_back(vector_of(*positions, i));
  if (const auto normals = attributes.find("NORMAL", 3, 3, count))
    for (const std::uint32_t i : used) {
      const V3f normal = vector_of(*normals, i);
      mesh.normals.push_back(is_finite(normal) ? normal.normalized() : V3f(0.0f));
    }
  for (const int set : {0, 1})
    if (const auto uvs = attributes.find("TEXCOORD_" + std::to_string(set), 2, 2, count))
      for (const std::uint32_t i : used) {
        const V2f uv(uvs->number(i, 0), uvs->number(i, 1));
        result.uvs[set].push_back(is_finite(uv) ? uv : V2f(0.0f));
      }
  if (const auto colors = attributes.find("COLOR_0", 3, 4, count)) read_colors(*colors, used, result);
  return result;
}

}  // namespace twopass
