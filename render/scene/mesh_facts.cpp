#include "render/scene/mesh_facts.h"

#include <algorithm>
#include <numeric>

namespace twopass {
namespace {

/// For each vertex the first one, in a fixed order, at the same position.
std::vector<std::uint32_t> weld(const std::vector<V3f>& positions) {
  std::vector<std::uint32_t> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) {
    const V3f& p = positions[i];
    return std::array<float, 3>{p.x, p.y, p.z};
  };
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && positions[order[i]] == positions[order[i - 1]] ? first[order[i - 1]] : order[i];
  return first;
}

struct Edge {
  std::uint32_t low, high;
  bool ascending;  // as its triangle runs along it
};

void count_edges(std::vector<Edge>& edges, MeshFacts& facts) {
  const auto key = [](const Edge& e) { return std::pair(e.low, e.high); };
  std::ranges::sort(edges, {}, key);
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && key(edges[end]) == key(edges[begin])) ++end;
    if (end - begin == 1)
      ++facts.open_edges;
    else if (end - begin > 2)
      ++facts.crowded_edges;
    else if (edges[begin].ascending == edges[begin + 1].ascending)
      ++facts.turned_edges;
  }
}

double signed_volume_from(const Mesh& mesh, const V3d& middle) {
  double sum = 0.0;
  for (const V3u& t : mesh.triangles) {
    const V3d a = V3d(mesh.positions[t.x]) - middle, b = V3d(mesh.positions[t.y]) - middle,
              c = V3d(mesh.positions[t.z]) - middle;
    sum += a.dot(b.cross(c)) / 6.0;
  }
  return sum;
}

}  // namespace

MeshFacts facts_of(const Mesh& mesh) {
  MeshFacts facts;
  const std::vector<std::uint32_t> point = weld(mesh.positions);
  std::vector<Edge> edges;
  std::vector<std::array<std::uint32_t, 3>> corners;
  edges.reserve(3 * mesh.triangles.size());
  corners.reserve(mesh.triangles.size());
  Box3f bounds;
  for (const V3u& t : mesh.triangles) {
    const V3d a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    const double area = 0.5 * (b - a).cross(c - a).length();
    facts.area += area;
    if (!(area > 0.0)) {
      ++facts.degenerate;
      continue;
    }
    std::array<std::uint32_t, 3> triangle{point[t.x], point[t.y], point[t.z]};
    for (std::size_t i = 0; i < 3; ++i) {
      bounds.extendBy(mesh.positions[triangle[i]]);
      const std::uint32_t from = triangle[i], to = triangle[(i + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), from < to});
    }
    std::ranges::sort(triangle);
    corners.push_back(triangle);
  }
  count_edges(edges, facts);
  std::ranges::sort(corners);
  for (std::size_t i = 1; i < corners.size(); ++i)
    if (corners[i] == corners[i - 1]) ++facts.duplicates;
  if (!bounds.isEmpty())
    facts.signed_volume = signed_volume_from(mesh, (V3d(bounds.min) + V3d(bounds.max)) * 0.5);
  return facts;
}

bool faces_inward(std::span<const Shape> shapes) {
  Box3f bounds;
  for (const Shape& shape : shapes)
    if (const Mesh* mesh = std::get_if<Mesh>(&shape.geometry))
      for (const V3f& p : mesh->positions) bounds.extendBy(p);
  if (bounds.isEmpty()) return false;
  const V3d middle = (V3d(bounds.min) + V3d(bounds.max)) * 0.5, size = V3d(bounds.max) - V3d(bounds.min);
  double volume = 0.0;
  for (const Shape& shape : shapes)
    if (const Mesh* mesh = std::get_if<Mesh>(&shape.geometry)) volume += signed_volume_from(*mesh, middle);
  return volume < -0.25 * size.x * size.y * size.z;
}

}  // namespace twopass
