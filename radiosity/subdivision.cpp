#include "radiosity/subdivision.h"

#include "radiosity/clusters.h"
#include "render/core/parallel.h"

namespace twopass {

namespace {

// Beyond this the float barycentric coordinates of a hit no longer tell neighbouring elements apart well.
constexpr int max_divisions = 4096;

// Every triangle (or piece) on a side that can hold a radiosity.
struct Roots {
  std::vector<ElementRoot> root;
  std::vector<double> area;
  std::vector<ClusterCandidate> candidate;
};

void add_side(Roots& roots, const Shape& shape, std::uint32_t s, Side side) {
  const std::size_t first = roots.root.size();
  const std::size_t primitives = piece_count(shape.geometry);
  roots.root.resize(first + primitives);
  roots.area.resize(first + primitives);
  roots.candidate.resize(first + primitives);
  parallel_for(primitives, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto primitive = static_cast<std::uint32_t>(k);
      roots.root[first + k] = {s, primitive, 0, no_index, 1, side};
      const Patch patch = piece_patch(shape.geometry, primitive, side);
      roots.area[first + k] = patch.area;
      roots.candidate[first + k] = cluster_candidate(patch, shape.material, side);
    }
  });
}

Roots find_roots(const Scene& scene) {
  Roots roots;
  for (std::uint32_t s = 0; s < scene.shapes().size(); ++s)
    for (const Side side : {front, back})
      if (can_hold_radiosity(scene, s, side)) add_side(roots, scene.shapes()[s], s, side);
  return roots;
}

// Elements of about one area. An edge is cut in 1 or in the base times a power of two, so that the grids of
// neighbours of unequal size nest and their irradiance can be joined without a seam; a free choice of the base
// lets the number of elements come near any budget. Triangles smaller than an element are joined.
struct Grid {
  double target_area;
  int base;  // odd: others are powers of two times one of these
  double
      largest_cluster;  // edge of the cubes, whatever the budget: beyond this they are too crude for anything

  // The least divisions with elements of at most the target area.
  [[nodiscard]] int divisions(double area) const {
    const double wanted = std::sqrt(area / target_area);
    int n = 1;
    while (n < wanted && 2 * n <= max_divisions) n = n == 1 ? std::max(2, base) : 2 * n;
    return n;
  }
  [[nodiscard]] float cluster_size() const {
    return static_cast<float>(std::min(std::sqrt(target_area), largest_cluster));
  }
  [[nodiscard]] double elements(const Roots& roots) const {
    double sum = 0.0;
    std::size_t small = 0;
    for (std::size_t r = 0; r < roots.root.size(); ++r) {
      if (roots.candidate[r].extent <= cluster_size())
        ++small;
      else
        sum += std::pow(divisions(roots.area[r]), 2);
    }
    return small == 0 ? sum : sum + count_clusters(roots.candidate, cluster_size());
  }
};

// The finest grid of this base with at most `max_elements` elements; none if even the coarsest has more.
Grid finest_grid(const Roots& roots, int base, double total_area, double extent, double max_elements) {
  // One that is certainly too coarse, and one that is certainly too fine.
  double high = 4.0 * extent * extent, low = std::min(high, total_area / max_elements / 16.0);
  // The logarithm of the interval is halved, down to about half a percent of the area.
  while (high / low > 1.005) {
    const double middle = std::sqrt(low * high);
    (Grid{middle, base, extent / 8.0}.elements(roots) <= max_elements ? high : low) = middle;
  }
  return {high, base, extent / 8.0};
}

}  // namespace

bool can_hold_radiosity(const Scene& scene, std::uint32_t shape, Side side) {
  const Material& material = scene.description().materials[scene.shapes()[shape].material];
  return !is_black(material.side[side].traits().mean_diffuse_reflectance);
}

ElementMesh divide_surfaces(const Scene& scene, std::size_t max_elements) {
  Roots roots = find_roots(scene);
  double total_area = 0.0;
  for (const double area : roots.area) total_area += area;
  std::vector<std::uint32_t> cluster;
  if (total_area > 0.0 && max_elements > 0) {
    const double extent = static_cast<double>((scene.bounds().max - scene.bounds().min).length());
    Grid best{0.0, 1, 0.0};
    for (const int base : {1, 3, 5, 7}) {
      const Grid grid = finest_grid(roots, base, total_area, extent, static_cast<double>(max_elements));
      if (base == 1 || grid.target_area < best.target_area) best = grid;
      if (roots.root.size() > max_elements) break;  // all but clusters: the base hardly matters
    }
    cluster = form_clusters(roots.candidate, best.cluster_size());
    for (std::size_t r = 0; r < roots.root.size(); ++r)
      roots.root[r].divisions =
          cluster[r] != no_index ? 0 : static_cast<std::uint16_t>(best.divisions(roots.area[r]));
  }
  return ElementMesh(scene.shapes(), scene.description().materials, std::move(roots.root), cluster);
}

}  // namespace twopass
