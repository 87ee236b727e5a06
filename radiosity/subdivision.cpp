#include "radiosity/subdivision.h"

namespace twopass {

namespace {

// Beyond this the float barycentric coordinates of a hit no longer tell neighbouring elements apart well.
constexpr int max_divisions = 4096;

// Every triangle (or octant) on a side that can hold a radiosity, with its area.
struct Roots {
  std::vector<ElementRoot> root;
  std::vector<double> area;
};

void add_side(Roots& roots, const Shape& shape, std::uint32_t s, Side side) {
  const auto add = [&](std::uint32_t primitive, double area) {
    roots.root.push_back({s, primitive, 0, 1, side});
    roots.area.push_back(area);
  };
  if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
    const double radius = sphere->radius;
    for (std::uint32_t octant = 0; octant < 8; ++octant) add(octant, 0.5 * pi * radius * radius);
  } else {
    const Mesh& mesh = std::get<Mesh>(shape.geometry);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) add(i, triangle_patch(mesh, i, side).area);
  }
}

Roots find_roots(const Scene& scene) {
  Roots roots;
  for (std::uint32_t s = 0; s < scene.shapes().size(); ++s)
    for (const Side side : {front, back})
      if (can_hold_radiosity(scene, s, side)) add_side(roots, scene.shapes()[s], s, side);
  return roots;
}

// Elements of about one area. Divisions are 1, 2, 4 or the base times a power of two, so that the grids of
// neighbours of unequal size nest and their irradiance can be joined without a seam; a free choice of the base
// lets the number of elements come near any budget.
struct Grid {
  double target_area;
  int base;  // 1 to 16

  // The base that suits the largest triangle best.
  Grid(double target, double largest_area) : target_area(target) {
    double divisions = std::sqrt(largest_area / target);
    while (divisions > 16.0) divisions *= 0.5;
    base = std::max(1, static_cast<int>(std::ceil(divisions)));
  }
  // The least divisions with elements of at most the target area.
  [[nodiscard]] int divisions(double area) const {
    const double wanted = std::sqrt(area / target_area);
    int n = 1;
    while (n < wanted && 2 * n <= max_divisions) n = n < base ? std::min(2 * n, base) : 2 * n;
    return n;
  }
  [[nodiscard]] double elements(const std::vector<double>& area) const {
    double sum = 0.0;
    for (const double a : area) sum += std::pow(divisions(a), 2);
    return sum;
  }
};

// The finest grid with at most `max_elements` elements. REQUIRES: there are fewer areas than that.
Grid finest_grid(const std::vector<double>& area, double max_elements) {
  const double largest = *std::max_element(area.begin(), area.end());
  double high = largest, low = largest / max_elements / static_cast<double>(area.size());
  // The logarithm of the interval is halved: 40 steps are below a float's resolution.
  for (int step = 0; step < 40; ++step) {
    const double middle = std::sqrt(low * high);
    (Grid(middle, largest).elements(area) <= max_elements ? high : low) = middle;
  }
  return Grid(high, largest);
}

}  // namespace

bool can_hold_radiosity(const Scene& scene, std::uint32_t shape, Side side) {
  const Bsdf& bsdf = scene.description().materials[scene.shapes()[shape].material].side[side];
  return !is_specular(bsdf) && !is_black(diffuse_reflectance(bsdf));
}

ElementMesh divide_surfaces(const Scene& scene, std::size_t max_elements) {
  Roots roots = find_roots(scene);
  const bool can_divide =
      !roots.root.empty() &&
      roots.root.size()<max_elements&& * std::max_element(roots.area.begin(), roots.area.end())> 0.0;
  if (can_divide) {
    const Grid grid = finest_grid(roots.area, static_cast<double>(max_elements));
    for (std::size_t r = 0; r < roots.root.size(); ++r)
      roots.root[r].divisions = static_cast<std::uint16_t>(grid.divisions(roots.area[r]));
  }
  return ElementMesh(scene.shapes(), scene.description().materials, std::move(roots.root));
}

}  // namespace twopass
