#include "render/load/obj_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "render/load/triangulate.h"

namespace twopass {
namespace {

bool is_same(const ObjCorner& a, const ObjCorner& b) {
  return a.position == b.position && a.uv == b.uv && a.normal == b.normal;
}

/// Numbers of vertices by their corners: a hash table with open addresses, because looking vertices up is most
/// of the work of making a mesh. Neighbours in space are neighbours in files, so a vertex is first looked for
/// at the slot of its position's index, which is in the cache more often than not, and only then by its hash.
class VertexTable {
 public:
  explicit VertexTable(std::size_t most_vertices)
      : slots_(std::bit_ceil(most_vertices + most_vertices / 3 + 1), no_obj_index) {}

  /// The number of the vertex with these indices. A new one is appended to `vertices`.
  std::uint32_t number(const ObjCorner& corner, std::vector<ObjCorner>& vertices) {
    std::size_t slot = corner.position & (slots_.size() - 1);
    if (slots_[slot] != no_obj_index && !is_same(vertices[slots_[slot]], corner)) {
      slot = hash(corner) & (slots_.size() - 1);
      while (slots_[slot] != no_obj_index && !is_same(vertices[slots_[slot]], corner))
        slot = (slot + 1) & (slots_.size() - 1);
    }
    if (slots_[slot] == no_obj_index) {
      slots_[slot] = static_cast<std::uint32_t>(vertices.size());
      vertices.push_back(corner);
    }
    return slots_[slot];
  }

 private:
  static std::size_t hash(const ObjCorner& c) {
    std::uint64_t h = c.position;
    for (const std::uint64_t more : {c.uv, c.normal}) h = (h ^ (h >> 32) ^ more) * 0x9e3779b97f4a7c15ull;
    return h ^ (h >> 32);
  }

  std::vector<std::uint32_t> slots_;
};

/// Mean normal of a polygon, not normalised; zero when it has no area.
V3d area_normal(std::span<const V3f> corners) {
  V3d sum(0.0);
  const V3d origin(corners[0]);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum += (V3d(corners[i]) - origin).cross(V3d(corners[i + 1]) - origin);
  return sum;
}

std::span<const ObjCorner> corners_of(const ObjFile& file, const ObjFace& face) {
  return {file.corners.data() + face.first_corner, face.corner_count};
}

void positions_of(const ObjFile& file, const ObjFace& face, std::vector<V3f>& points) {
  points.clear();
  for (const ObjCorner& corner : corners_of(file, face)) points.push_back(file.positions[corner.position]);
}

template <class Visit>
void for_each_face(const ObjFile& file, std::span<const FaceRange> ranges, const Visit& visit) {
  for (const FaceRange& range : ranges)
    for (std::uint32_t f = range.first; f < range.end; ++f) visit(file.faces[f]);
}

/// What the faces of a mesh have.
struct Contents {
  std::size_t corners = 0, triangles = 0;
  bool normals = false, uvs = false;
};
Contents contents_of(const ObjFile& file, std::span<const FaceRange> ranges) {
  Contents contents;
  for_each_face(file, ranges, [&](const ObjFace& face) {
    contents.corners += face.corner_count;
    contents.triangles += face.corner_count - 2;
    for (const ObjCorner& corner : corners_of(file, face)) {
      contents.normals |= corner.normal != no_obj_index;
      contents.uvs |= corner.uv != no_obj_index;
    }
  });
  return contents;
}

/// A smoothing group at a position.
using SmoothPoint = std::uint64_t;
SmoothPoint smooth_point(std::uint32_t position, std::uint32_t group) {
  return static_cast<std::uint64_t>(group) << 32 | position;
}

}  // namespace

Mesh mesh_of_faces(const ObjFile& file, std::span<const FaceRange> ranges) {
  const Contents contents = contents_of(file, ranges);
  VertexTable table(contents.corners);
  std::vector<ObjCorner> vertices;
  // A face's own normal is nobody else's: such normals are numbered from the far end, clear of the file's.
  std::vector<V3f> face_normals;
  const auto own_normal = [](std::size_t index) {
    return no_obj_index - 1 - static_cast<std::uint32_t>(index);
  };

  Mesh mesh;
  mesh.triangles.reserve(contents.triangles);
  std::vector<V3f> points;
  std::vector<std::uint32_t> ring;
  for_each_face(file, ranges, [&](const ObjFace& face) {
    bool needs_own = false;
    ring.clear();
    for (ObjCorner corner : corners_of(file, face)) {
      if (!contents.normals) {
        corner.normal = no_obj_index;
      } else if (corner.normal == no_obj_index) {
        corner.normal = own_normal(face_normals.size());
        needs_own = true;
      }
      ring.push_back(table.number(corner, vertices));
    }
    if (ring.size() == 3) mesh.triangles.emplace_back(ring[0], ring[1], ring[2]);
    if (ring.size() == 3 && !needs_own) return;
    positions_of(file, face, points);
    if (needs_own) face_normals.push_back(V3f(area_normal(points).normalized()));
    if (ring.size() > 3)
      for (const auto& [a, b, c] : triangulate(points)) mesh.triangles.emplace_back(ring[a], ring[b], ring[c]);
  });

  mesh.positions.reserve(vertices.size());
  for (const ObjCorner& v : vertices) mesh.positions.push_back(file.positions[v.position]);
  if (contents.normals) mesh.normals.reserve(vertices.size());
  if (contents.uvs) mesh.uvs.reserve(vertices.size());
  for (const ObjCorner& v : vertices) {
    if (contents.normals)
      mesh.normals.push_back(v.normal < file.normals.size() ? file.normals[v.normal]
                                                            : face_normals[own_normal(v.normal)]);
    if (contents.uvs) mesh.uvs.push_back(v.uv == no_obj_index ? V2f(0.0f) : file.uvs[v.uv]);
  }
  return mesh;
}

void add_smooth_normals(ObjFile& file) {
  std::unordered_map<SmoothPoint, V3d> sums;
  std::vector<V3f> points;
  const auto needs_normals = [&](const ObjFace& face) {
    return face.smoothing != 0 && std::ranges::any_of(corners_of(file, face), [](const ObjCorner& corner) {
             return corner.normal == no_obj_index;
           });
  };
  for (const ObjFace& face : file.faces) {
    if (!needs_normals(face)) continue;
    positions_of(file, face, points);
    const V3d normal = area_normal(points).normalized();
    const std::size_t n = points.size();
    for (std::size_t i = 0; i < n; ++i) {
      const V3d here(points[i]), e = V3d(points[(i + 1) % n]) - here, f = V3d(points[(i + n - 1) % n]) - here;
      V3d& sum =
          sums.try_emplace(smooth_point(corners_of(file, face)[i].position, face.smoothing), 0.0).first->second;
      sum += normal * std::atan2(e.cross(f).length(), e.dot(f));
    }
  }
  if (sums.empty()) return;

  std::unordered_map<SmoothPoint, std::uint32_t> known;
  for (const ObjFace& face : file.faces) {
    if (!needs_normals(face)) continue;
    positions_of(file, face, points);
    const V3d own = area_normal(points);
    for (std::uint32_t i = 0; i < face.corner_count; ++i) {
      ObjCorner& corner = file.corners[face.first_corner + i];
      if (corner.normal != no_obj_index) continue;
      const SmoothPoint point = smooth_point(corner.position, face.smoothing);
      const V3d& sum = sums.at(point);
      if (!(sum.dot(own) > 0.0)) continue;
      const auto [entry, is_new] = known.try_emplace(point, static_cast<std::uint32_t>(file.normals.size()));
      if (is_new) file.normals.push_back(V3f(sum.normalized()));
      corner.normal = entry->second;
    }
  }
}

}  // namespace twopass
