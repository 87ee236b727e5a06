#include "radiosity/smoothing.h"

#include "render/core/interrupt.h"

namespace twopass {

namespace {

// At a vertex with more elements than this, the tip of a fan, they are not all made neighbours of each other:
// pairs would take for ever.
constexpr std::size_t most_neighbours_at_vertex = 32;

Irradiance blend(const Irradiance& a, const Irradiance& b, double t) {
  const auto mix = [&](const C3f& x, const C3f& y) { return C3f(C3d(x) + (C3d(y) - C3d(x)) * t); };
  return {mix(a.direct, b.direct), mix(a.indirect, b.indirect)};
}

// Sums of weight x irradiance. In double, the mean of equal floats is that float.
struct Weighted {
  C3d direct{0.0}, indirect{0.0};
  double weight = 0.0;

  void add(const Irradiance& irradiance, double w) {
    direct += C3d(irradiance.direct) * w;
    indirect += C3d(irradiance.indirect) * w;
    weight += w;
  }
  [[nodiscard]] Irradiance mean() const {
    if (!(weight > 0.0)) return {};
    return {C3f(direct / weight), C3f(indirect / weight)};
  }
};

// Calls visit(face, element) for all faces.
template <class Visit>
void for_each_face(const VertexMesh& vertices, const ElementMesh& mesh, Visit visit) {
  auto face = static_cast<std::uint32_t>(vertices.faces().cells);
  for (std::uint32_t element = 0; element < face; ++element) visit(element, element);
  for (std::uint32_t element = face; element < mesh.count(); ++element)
    for (std::size_t k = 0; k < mesh.patch_count(element); ++k) visit(face++, element);
}

// Lists of numbers by index, from pairs.
class Lists {
 public:
  // Sorts the pairs and drops repetitions.
  Lists(std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs, std::size_t count) : first_(count + 1, 0) {
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    for (const auto& [index, entry] : pairs) {
      ++first_[index + 1];
      entry_.push_back(entry);
    }
    for (std::size_t k = 0; k < count; ++k) first_[k + 1] += first_[k];
  }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t index) const {
    return {entry_.data() + first_[index], entry_.data() + first_[index + 1]};
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> entry_;
};

// Values at the vertices of clusters. A mean over the few triangles around each would be flat in the middle of
// a cluster and step within one triangle to the next; a Gaussian about half as wide as clusters are makes it a
// slope.
class ClusterSmoothing {
 public:
  ClusterSmoothing(const VertexMesh& vertices, const ElementMesh& mesh)
      : vertices_(vertices),
        mesh_(mesh),
        elements_(elements_at_vertices(), vertices.count()),
        neighbours_(neighbours(), mesh.count()),
        centroid_(mesh.count()) {
    for (std::uint32_t element = 0; element < mesh.count(); ++element) {
      if (element < vertices.faces().cells && !is_near_[element]) continue;
      V3d sum(0.0);
      for (std::size_t k = 0; k < mesh.patch_count(element); ++k) {
        const Patch patch = mesh.patch(element, k);
        sum += patch.centroid().position * patch.area;
      }
      const double area = mesh.whole_area(element);
      centroid_[element] = area > 0.0 ? sum / area : mesh.patch(element).corner[0];
    }
  }

  // Replaces the values of the vertices that clusters have.
  void apply(std::span<const Irradiance> irradiance, std::vector<Irradiance>& value) {
    std::vector<std::uint32_t> around;
    for (std::uint32_t vertex = 0; vertex < vertices_.count(); ++vertex) {
      const std::span<const std::uint32_t> here = elements_[vertex];
      if (here.empty()) continue;
      around.assign(here.begin(), here.end());
      double area = 0.0;
      std::size_t clusters = 0;
      for (const std::uint32_t element : here) {
        if (!mesh_.is_cluster(element)) continue;
        around.insert(around.end(), neighbours_[element].begin(), neighbours_[element].end());
        area += mesh_.area(element);
        ++clusters;
      }
      std::sort(around.begin(), around.end());
      around.erase(std::unique(around.begin(), around.end()), around.end());
      value[vertex] = mean(V3d(vertices_.position(vertex)), around, 0.25 * area / static_cast<double>(clusters),
                           irradiance);
    }
  }

 private:
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

  Pairs elements_at_vertices() {
    std::vector<bool> wanted(vertices_.count(), false);
    const VertexMesh::Faces& faces = vertices_.faces();
    for (std::size_t face = faces.cells; face < faces.corner.size(); ++face)
      for (const std::uint32_t vertex : faces.corner[face]) wanted[vertex] = true;
    Pairs pairs;
    is_near_.assign(faces.cells, false);
    for_each_face(vertices_, mesh_, [&](std::uint32_t face, std::uint32_t element) {
      for (const std::uint32_t vertex : faces.corner[face]) {
        if (!wanted[vertex]) continue;
        pairs.emplace_back(vertex, element);
        if (element < faces.cells) is_near_[element] = true;
      }
    });
    return pairs;
  }

  [[nodiscard]] Pairs neighbours() const {
    Pairs pairs;
    for (std::size_t vertex = 0; vertex < vertices_.count(); ++vertex) {
      const std::span<const std::uint32_t> here = elements_[vertex];
      if (here.size() < 2 || here.size() > most_neighbours_at_vertex) continue;
      for (const std::uint32_t cluster : here)
        for (const std::uint32_t other : here)
          if (other != cluster && mesh_.is_cluster(cluster)) pairs.emplace_back(cluster, other);
    }
    return pairs;
  }

  // `variance` of the Gaussian, in units of area; only the distances beyond the nearest element's matter, so
  // that one weight at least is not tiny.
  [[nodiscard]] Irradiance mean(const V3d& position, std::span<const std::uint32_t> around, double variance,
                                std::span<const Irradiance> irradiance) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::uint32_t element : around)
      if (mesh_.area(element) > 0.0) nearest = std::min(nearest, (centroid_[element] - position).length2());
    Weighted sum;
    for (const std::uint32_t element : around) {
      const double farther = (centroid_[element] - position).length2() - nearest;
      const double weight = farther > 0.0 ? std::exp(-farther / (2.0 * variance)) : 1.0;
      if (weight > 0.0) sum.add(irradiance[element], mesh_.area(element) * weight);
    }
    return sum.mean();
  }

  const VertexMesh& vertices_;
  const ElementMesh& mesh_;
  std::vector<bool> is_near_;  // by element but clusters: it touches one
  Lists elements_;             // by vertex of a cluster
  Lists neighbours_;           // by cluster: elements that share a vertex with it
  std::vector<V3d> centroid_;  // by element
};

}  // namespace

std::vector<Irradiance> vertex_irradiance(const VertexMesh& vertices, const ElementMesh& mesh,
                                          std::span<const Irradiance> irradiance) {
  const VertexMesh::Faces& faces = vertices.faces();
  std::vector<Weighted> sums(vertices.count());
  for (std::uint32_t face = 0; face < faces.cells; ++face)
    for (const std::uint32_t vertex : faces.corner[face]) sums[vertex].add(irradiance[face], mesh.area(face));
  std::vector<Irradiance> value;
  value.reserve(sums.size());
  for (const Weighted& sum : sums) value.push_back(sum.mean());
  throw_if_interrupted();
  if (mesh.cluster_count() > 0) ClusterSmoothing(vertices, mesh).apply(irradiance, value);
  for (const VertexMesh::Hanging& h : vertices.hanging())
    value[h.vertex] = blend(value[h.from], value[h.to], static_cast<double>(h.t));
  return value;
}

SmoothIrradiance::SmoothIrradiance(const ElementMesh& mesh, std::span<const Irradiance> irradiance) {
  VertexMesh vertices(mesh);
  value_ = vertex_irradiance(vertices, mesh, irradiance);
  faces_ = std::move(vertices).take_faces();
}

Irradiance SmoothIrradiance::at(const ElementMesh::Location& location) const {
  const std::array<std::uint32_t, 3>& corner = faces_.corner[faces_.find(location)];
  // Rounding may have left the cell by a hair: interpolation must not become extrapolation.
  const double u = std::clamp(static_cast<double>(location.u), 0.0, 1.0);
  const double v = std::clamp(static_cast<double>(location.v), 0.0, 1.0 - u);
  const auto interpolate = [&](C3f Irradiance::*part) {
    const C3d a(value_[corner[0]].*part), b(value_[corner[1]].*part), c(value_[corner[2]].*part);
    return C3f(a + (b - a) * u + (c - a) * v);
  };
  return {interpolate(&Irradiance::direct), interpolate(&Irradiance::indirect)};
}

}  // namespace twopass
