#include "render/load/mesh_tools.h"

#include "render/core/error.h"

namespace twopass {
namespace {

/// Twice the area times the normal of a triangle, in double: exact enough for the thinnest float triangle.
V3d area_normal(const Mesh& mesh, const V3u& t) {
  const V3d a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
  return (b - a).cross(c - a);
}

/// The cofactors of the upper 3x3 matrix: its inverse transpose but for a factor, defined for singular ones
/// too.
V3d transform_normal(const V3d& n, const M44d& m) {
  const V3d r0(m[0][0], m[0][1], m[0][2]), r1(m[1][0], m[1][1], m[1][2]), r2(m[2][0], m[2][1], m[2][2]);
  const V3d normal = r1.cross(r2) * n.x + r2.cross(r0) * n.y + r0.cross(r1) * n.z;
  return is_mirroring(m) ? -normal : normal;
}

}  // namespace

bool is_mirroring(const M44d& m) {
  const V3d r0(m[0][0], m[0][1], m[0][2]), r1(m[1][0], m[1][1], m[1][2]), r2(m[2][0], m[2][1], m[2][2]);
  return r0.cross(r1).dot(r2) < 0.0;
}

void transform(Mesh& mesh, const M44d& to_world, std::string_view where) {
  for (V3f& position : mesh.positions) {
    V3d p;
    to_world.multVecMatrix(V3d(position), p);
    for (int axis = 0; axis < 3; ++axis)
      if (!(std::abs(p[axis]) <= largest_coordinate))
        throw Error(where, "a transformed coordinate is not finite or larger than 1e12",
                    "use larger units or check the transform");
    position = V3f(p);
  }
  for (V3f& normal : mesh.normals) normal = V3f(transform_normal(V3d(normal), to_world).normalized());
}

void reverse_winding(Mesh& mesh) {
  for (V3u& triangle : mesh.triangles) std::swap(triangle.y, triangle.z);
}

void flip(Mesh& mesh) {
  reverse_winding(mesh);
  for (V3f& normal : mesh.normals) normal = -normal;
}

std::size_t drop_degenerate_triangles(Mesh& mesh) {
  const auto has_area = [&](const V3u& t) {
    // The float product is what everybody downstream divides by; it may underflow where the exact one does not.
    const V3f &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    const float length = (b - a).cross(c - a).length();
    return length > 0.0f && std::isfinite(length) && area_normal(mesh, t).length() > 0.0;
  };
  const std::size_t before = mesh.triangles.size();
  std::size_t left = 0;
  for (std::size_t i = 0; i < before; ++i) {
    if (!has_area(mesh.triangles[i])) continue;
    for (MeshAttribute& attribute : mesh.attributes)
      if (attribute.is_of_faces()) attribute.values[left] = attribute.values[i];
    mesh.triangles[left++] = mesh.triangles[i];
  }
  if (left == before) return 0;
  mesh.triangles.resize(left);
  for (MeshAttribute& attribute : mesh.attributes)
    if (attribute.is_of_faces()) attribute.values.resize(left);

  constexpr std::uint32_t unused = 0xffffffffu;
  std::vector<std::uint32_t> renamed(mesh.positions.size(), unused);
  Mesh kept;
  for (const MeshAttribute& attribute : mesh.attributes) kept.attributes.push_back({attribute.name, {}});
  const auto keep = [&](std::uint32_t& index) {
    if (renamed[index] == unused) {
      renamed[index] = static_cast<std::uint32_t>(kept.positions.size());
      kept.positions.push_back(mesh.positions[index]);
      if (!mesh.normals.empty()) kept.normals.push_back(mesh.normals[index]);
      if (!mesh.uvs.empty()) kept.uvs.push_back(mesh.uvs[index]);
      for (std::size_t a = 0; a < mesh.attributes.size(); ++a)
        if (!mesh.attributes[a].is_of_faces())
          kept.attributes[a].values.push_back(mesh.attributes[a].values[index]);
    }
    index = renamed[index];
  };
  for (V3u& t : mesh.triangles) {
    keep(t.x);
    keep(t.y);
    keep(t.z);
  }
  for (std::size_t a = 0; a < mesh.attributes.size(); ++a)
    if (mesh.attributes[a].is_of_faces()) kept.attributes[a] = std::move(mesh.attributes[a]);
  kept.triangles = std::move(mesh.triangles);
  mesh = std::move(kept);
  return before - left;
}

void compute_smooth_normals(Mesh& mesh) {
  std::vector<V3d> sums(mesh.positions.size(), V3d(0.0)), any(mesh.positions.size(), V3d(0.0, 0.0, 1.0));
  for (const V3u& t : mesh.triangles) {
    const std::uint32_t index[3] = {t.x, t.y, t.z};
    const V3d normal = area_normal(mesh, t).normalized();
    for (int i = 0; i < 3; ++i) {
      const V3d p(mesh.positions[index[i]]);
      const V3d e = V3d(mesh.positions[index[(i + 1) % 3]]) - p,
                f = V3d(mesh.positions[index[(i + 2) % 3]]) - p;
      sums[index[i]] += normal * std::atan2(e.cross(f).length(), e.dot(f));
      any[index[i]] = normal;
    }
  }
  mesh.normals.resize(mesh.positions.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    // Two sides of a sheet through the same position cancel: any of them will do.
    const bool cancelled = sums[i].length() < 1e-6;
    mesh.normals[i] = V3f(cancelled ? any[i] : sums[i].normalized());
  }
}

std::size_t orient_by_normals(Mesh& mesh) {
  if (mesh.normals.empty()) return 0;
  std::size_t reversed = 0;
  for (V3u& t : mesh.triangles) {
    const V3d sum = V3d(mesh.normals[t.x]) + V3d(mesh.normals[t.y]) + V3d(mesh.normals[t.z]);
    if (sum.dot(area_normal(mesh, t)) >= 0.0) continue;
    std::swap(t.y, t.z);
    ++reversed;
  }
  return reversed;
}

void drop_flat_normals(Mesh& mesh) {
  if (mesh.normals.empty()) return;
  for (const V3u& t : mesh.triangles) {
    const V3d normal = area_normal(mesh, t).normalized();
    for (const std::uint32_t corner : {t.x, t.y, t.z})
      // The normals of text files have three or four digits: 1e-3 rad is as flat as they can say.
      if ((V3d(mesh.normals[corner]) - normal).length() > 1e-3) return;
  }
  mesh.normals.clear();
}

}  // namespace twopass
