#include "radiosity/smoothing.h"

#include <tuple>

namespace twopass {

namespace {

constexpr double smallest_cosine = 0.86602540378443865;  // of 30 degrees
// A vertex where more triangles meet than this is the tip of a fan; comparing all pairs there would take for
// ever.
constexpr std::size_t most_at_vertex = 256;

std::tuple<double, double, double> key(const V3d& p) { return {p.x, p.y, p.z}; }

// Vertex k of edge `edge` (from corner `edge` to the next) of a grid.
V2i edge_vertex(int edge, int k, int divisions) {
  if (edge == 0) return {k, 0};
  if (edge == 1) return {divisions - k, k};
  return {0, divisions - k};
}

int divisions_of(const ElementRoot& root) { return std::max<int>(1, root.divisions); }

ElementCell cell_of(const ElementMesh& mesh, const ElementRoot& root, std::uint32_t element) {
  return root.divisions == 0 ? ElementCell{0, 0, false, 1} : mesh.cell(element);
}

V3d root_normal(const ElementMesh& mesh, const ElementRoot& root) {
  if (mesh.is_sphere(root.shape)) return V3d(0.0);
  return triangle_patch(std::get<Mesh>(mesh.shapes()[root.shape].geometry), root.primitive, root.side).normal;
}

// Whether two roots that touch are parts of one smooth surface.
bool continues(const ElementRoot& a, const V3d& normal_a, const ElementRoot& b, const V3d& normal_b,
               const ElementMesh& mesh) {
  if (mesh.is_sphere(a.shape) || mesh.is_sphere(b.shape)) return a.shape == b.shape && a.side == b.side;
  return normal_a.dot(normal_b) >= smallest_cosine;
}

Irradiance blend(const Irradiance& a, const Irradiance& b, float t) {
  return {a.direct * (1.0f - t) + b.direct * t, a.indirect * (1.0f - t) + b.indirect * t};
}

}  // namespace

// Sums of area x irradiance over the elements around a vertex.
struct SmoothIrradiance::Weighted {
  C3d direct{0.0}, indirect{0.0};
  double area = 0.0;

  void add(const Irradiance& irradiance, double weight) {
    direct += C3d(irradiance.direct) * weight;
    indirect += C3d(irradiance.indirect) * weight;
    area += weight;
  }
  void add(const Weighted& other) {
    direct += other.direct;
    indirect += other.indirect;
    area += other.area;
  }
  [[nodiscard]] Irradiance mean() const {
    if (!(area > 0.0)) return {};
    return {C3f(direct * (1.0 / area)), C3f(indirect * (1.0 / area))};
  }
};

struct SmoothIrradiance::BorderVertex {
  V3d position, normal;
  std::uint32_t root;
  std::size_t vertex;
};

struct SmoothIrradiance::BorderEdge {
  V3d from, to;  // in ascending order, whichever way the edge runs
  V3d normal;
  std::uint32_t root;
  int edge;
  bool reversed;

  // Numerators of vertex k counted from `from`.
  [[nodiscard]] V2i vertex(int k, int divisions) const {
    return edge_vertex(edge, reversed ? divisions - k : k, divisions);
  }
};

SmoothIrradiance::SmoothIrradiance(const ElementMesh& mesh, std::span<const Irradiance> irradiance) {
  std::vector<Weighted> sums = sum_elements(mesh, irradiance);
  weld_borders(mesh, sums);
  value_.reserve(sums.size());
  for (const Weighted& sum : sums) value_.push_back(sum.mean());
  align_hanging_vertices(mesh);
}

std::size_t SmoothIrradiance::vertex(const ElementMesh& mesh, std::uint32_t root, const V2i& numerators) const {
  // Row y of a grid of n divisions has n + 1 - y vertices.
  const auto n = static_cast<std::size_t>(divisions_of(mesh.roots()[root]));
  const auto x = static_cast<std::size_t>(numerators.x), y = static_cast<std::size_t>(numerators.y);
  return first_vertex_[root] + y * (2 * n + 3 - y) / 2 + x;
}

std::vector<SmoothIrradiance::Weighted> SmoothIrradiance::sum_elements(const ElementMesh& mesh,
                                                                       std::span<const Irradiance> irradiance) {
  std::size_t vertices = 0;
  for (const ElementRoot& root : mesh.roots()) {
    first_vertex_.push_back(vertices);
    const auto n = static_cast<std::size_t>(divisions_of(root));
    vertices += (n + 1) * (n + 2) / 2;
  }
  std::vector<Weighted> sums(vertices);
  for (std::uint32_t r = 0; r < mesh.roots().size(); ++r) {
    const ElementRoot& root = mesh.roots()[r];
    const std::uint32_t cells = static_cast<std::uint32_t>(divisions_of(root) * divisions_of(root));
    for (std::uint32_t element = root.first_element; element < root.first_element + cells; ++element)
      for (const V2i& corner : cell_corners(cell_of(mesh, root, element)))
        sums[vertex(mesh, r, corner)].add(irradiance[element], mesh.area(element));
  }
  return sums;
}

void SmoothIrradiance::weld_borders(const ElementMesh& mesh, std::vector<Weighted>& sums) const {
  std::vector<BorderVertex> border;
  for (std::uint32_t r = 0; r < mesh.roots().size(); ++r) {
    const ElementRoot& root = mesh.roots()[r];
    const V3d normal = root_normal(mesh, root);
    for (int edge = 0; edge < 3; ++edge)
      for (int k = 0; k < divisions_of(root); ++k) {
        const V2i numerators = edge_vertex(edge, k, divisions_of(root));
        border.push_back({mesh.grid_point(root, numerators, static_cast<std::uint32_t>(divisions_of(root))),
                          normal, r, vertex(mesh, r, numerators)});
      }
  }
  std::sort(border.begin(), border.end(), [](const BorderVertex& a, const BorderVertex& b) {
    return std::tuple(key(a.position), a.vertex) < std::tuple(key(b.position), b.vertex);
  });
  const std::vector<Weighted> own = sums;
  for (std::size_t begin = 0, end = 0; begin < border.size(); begin = end) {
    while (end < border.size() && border[end].position == border[begin].position) ++end;
    if (end - begin > most_at_vertex) continue;
    // Every vertex of the group adds up in the same order, so that equal sets have equal sums.
    for (std::size_t i = begin; i < end; ++i) {
      Weighted sum;
      for (std::size_t j = begin; j < end; ++j)
        if (continues(mesh.roots()[border[i].root], border[i].normal, mesh.roots()[border[j].root],
                      border[j].normal, mesh))
          sum.add(own[border[j].vertex]);
      sums[border[i].vertex] = sum;
    }
  }
}

// Where a coarse triangle meets a finer one, the finer one's vertices between the coarse ones take the values
// that the coarse one interpolates there: otherwise the edge would show.
void SmoothIrradiance::align_hanging_vertices(const ElementMesh& mesh) {
  std::vector<BorderEdge> edges;
  for (std::uint32_t r = 0; r < mesh.roots().size(); ++r) {
    const ElementRoot& root = mesh.roots()[r];
    for (int edge = 0; edge < 3; ++edge) {
      V3d from = mesh.grid_point(root, edge_vertex(edge, 0, divisions_of(root)),
                                 static_cast<std::uint32_t>(divisions_of(root)));
      V3d to = mesh.grid_point(root, edge_vertex(edge, divisions_of(root), divisions_of(root)),
                               static_cast<std::uint32_t>(divisions_of(root)));
      const bool reversed = key(to) < key(from);
      if (reversed) std::swap(from, to);
      edges.push_back({from, to, root_normal(mesh, root), r, edge, reversed});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const BorderEdge& a, const BorderEdge& b) {
    return std::tuple(key(a.from), key(a.to), a.root, a.edge) <
           std::tuple(key(b.from), key(b.to), b.root, b.edge);
  });
  const std::vector<Irradiance> own = value_;
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].from == edges[begin].from && edges[end].to == edges[begin].to)
      ++end;
    if (end - begin > most_at_vertex) continue;
    for (std::size_t i = begin; i < end; ++i) {
      const ElementRoot& fine = mesh.roots()[edges[i].root];
      const BorderEdge* coarsest = &edges[i];
      for (std::size_t j = begin; j < end; ++j)
        if (divisions_of(mesh.roots()[edges[j].root]) < divisions_of(mesh.roots()[coarsest->root]) &&
            continues(fine, edges[i].normal, mesh.roots()[edges[j].root], edges[j].normal, mesh))
          coarsest = &edges[j];
      const int n = divisions_of(fine), m = divisions_of(mesh.roots()[coarsest->root]);
      for (int k = 1; k < n && m < n; ++k) {
        const int left = k * m / n;
        const float t = static_cast<float>(k * m - left * n) / static_cast<float>(n);
        value_[vertex(mesh, edges[i].root, edges[i].vertex(k, n))] =
            blend(own[vertex(mesh, coarsest->root, coarsest->vertex(left, m))],
                  own[vertex(mesh, coarsest->root, coarsest->vertex(left + 1, m))], t);
      }
    }
  }
}

Irradiance SmoothIrradiance::at(const ElementMesh& mesh, const ElementMesh::Location& location) const {
  const std::uint32_t r = location.root;
  const std::array<V2i, 3> corner = cell_corners(cell_of(mesh, mesh.roots()[r], location.element));
  // Rounding may have left the cell by a hair: interpolation must not become extrapolation.
  const float u = std::clamp(location.u, 0.0f, 1.0f), v = std::clamp(location.v, 0.0f, 1.0f - u);
  const std::array<float, 3> weight{1.0f - u - v, u, v};
  Irradiance result;
  for (int k = 0; k < 3; ++k) {
    const Irradiance& value = value_[vertex(mesh, r, corner[k])];
    result.direct += value.direct * weight[k];
    result.indirect += value.indirect * weight[k];
  }
  return result;
}

}  // namespace twopass
