#include "radiosity/element_tree.h"

#include "radiosity/lambert.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"
#include "render/scene/geometry.h"

namespace twopass {

namespace {

// Cells are numbered as ElementMesh does it: row by row; a row holds 2 (divisions - row) - 1 of them.
std::uint32_t element_of_cell(const ElementRoot& root, const TreeNode& node) {
  if (node.own_element != no_index) return node.own_element;
  return root.first_element + node.row * (2u * root.divisions - node.row) + 2u * node.column +
         (node.inverted ? 1u : 0u);
}

// On the root's grid, counter-clockwise seen from the front. Three, or four of a strip.
std::array<V2i, 4> grid_corners(const TreeNode& node) {
  const V2i p(node.column, node.row);
  const int n = node.size;
  if (node.kind == TreeNode::strip) return {p + V2i(1, 0), p + V2i(n + 1, 0), p + V2i(n, 1), p + V2i(0, 1)};
  if (node.inverted) return {p + V2i(n, n), p + V2i(0, n), p + V2i(n, 0), p};
  return {p, p + V2i(n, 0), p + V2i(0, n), p};
}

bool is_on_analytic(const ElementMesh& mesh, const TreeNode& node) {
  return node.kind != TreeNode::cluster && !node.is_patchwork &&
         mesh.is_analytic(mesh.roots()[node.root].shape);
}

// The nearest of the 26 directions from the middle of a cube to its faces, edges and corners.
std::uint32_t direction_bin(const V3f& normal) {
  const float half = 0.5f * max_abs_component(normal);
  std::uint32_t bin = 0;
  for (int k = 0; k < 3; ++k) bin = 3 * bin + (normal[k] > half ? 2u : normal[k] < -half ? 0u : 1u);
  return bin;
}
constexpr std::uint32_t direction_bins = 27;

float angle_between(const V3f& a, const V3f& b) {
  return 2.0f * std::atan2((a - b).length(), (a + b).length());  // exact for small angles too
}

// Sizes, centre, axis and cone from the geometry.
void measure(TreeNode& node, const NodeSurface& surface) {
  const Patch& patch = surface.patch;
  ElementPoint middle{polygon_centroid(surface.polygon), surface.normal, surface.offset};
  if (patch.is_analytic()) middle = patch.above(middle.position);
  const double radius = polygon_radius(surface.polygon, middle.position);
  if (patch.on_sphere)
    node.cone =
        static_cast<float>(2.0 * std::asin(std::min(1.0, 0.5 * radius / std::abs(patch.signed_radius))));
  for (int k = 0; patch.cylinder && k < surface.polygon.n; ++k)
    node.cone = std::max(
        node.cone, angle_between(V3f(patch.above(surface.polygon.v[k]).normal), V3f(middle.normal)) + 1e-6f);
  // The corners are farthest from the middle, on analytic surfaces, too; a few digits more for rounding.
  node.radius = static_cast<float>(radius * (1.0 + 1e-5));
  node.is_flat = !patch.is_analytic();
  node.center = V3f(middle.position);
  node.axis = V3f(middle.normal);
  node.whole_area = polygon_area(surface.polygon) * surface.area_scale;
}

}  // namespace

ElementPoint NodeSurface::sample(const V2f& u) const {
  if (polygon.n != 4) return patch.sample(u);
  const V3d a = polygon.v[1] - polygon.v[0], b = polygon.v[3] - polygon.v[0];
  return {polygon.v[0] + a * u.x + b * u.y, normal, offset};
}

std::array<ElementPoint, 4> NodeSurface::quarters() const {
  std::array<ElementPoint, 4> point;
  const V3d middle = polygon_centroid(polygon);
  for (int k = 0; k < 4; ++k) {
    const V3d position = k < polygon.n ? (polygon.v[k] + middle) * 0.5 : middle;
    point[k] = patch.is_analytic() ? patch.above(position) : ElementPoint{position, normal, offset};
  }
  return point;
}

// Breadth first: a node's children are appended when its turn comes, so they follow each other and come later.
class ElementTree::Builder {
 public:
  explicit Builder(ElementTree& tree) : tree_(tree), mesh_(tree.mesh_) {}

  void run() {
    collect_items();
    parallel_for(items_.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        if (items_[i].is_patchwork)
          measure_patchwork(items_[i]);
        else
          measure(items_[i], tree_.surface(items_[i]));
    });
    tree_.node_.reserve(3 * mesh_.count() / 2 + 32);
    tree_.node_.push_back(cluster(0, static_cast<std::uint32_t>(items_.size())));
    tree_.level_ = {0, 1};
    while (tree_.level_.back() > tree_.level_[tree_.level_.size() - 2]) grow_level();
    tree_.level_.pop_back();
  }

 private:
  static TreeNode triangle(std::uint32_t root, int column, int row, int size, bool inverted) {
    TreeNode node;
    node.root = root;
    node.column = static_cast<std::uint16_t>(column);
    node.row = static_cast<std::uint16_t>(row);
    node.size = static_cast<std::uint16_t>(size);
    node.inverted = inverted;
    node.kind = size == 1 ? TreeNode::element : TreeNode::triangle;
    return node;
  }
  static TreeNode strip(std::uint32_t root, int column, int row, int size) {
    TreeNode node = triangle(root, column, row, size, false);
    node.kind = TreeNode::strip;
    return node;
  }

  // Roots whose elements are the cells of a grid, and all other elements by themselves.
  void collect_items() {
    const std::span<const ElementRoot> roots = mesh_.roots();
    for (std::uint32_t r = 0; r < roots.size(); ++r)
      if (is_grid(roots[r])) items_.push_back(triangle(r, 0, 0, roots[r].divisions, false));
    for (std::uint32_t e = 0; e < mesh_.count(); ++e) {
      if (is_grid(mesh_.root(e))) continue;
      TreeNode item;
      item.kind = TreeNode::element;
      item.root = mesh_.root_index(e);
      item.own_element = e;
      item.is_patchwork = mesh_.is_cluster(e);
      items_.push_back(item);
    }
  }
  static bool is_grid(const ElementRoot& root) { return root.divisions > 0 && root.first_cell == no_index; }

  void measure_patchwork(TreeNode& node) const {
    Imath::Box<V3d> box;
    V3d axis(0.0);
    const std::size_t patches = mesh_.patch_count(node.own_element);
    for (std::size_t k = 0; k < patches; ++k) {
      const Patch patch = mesh_.patch(node.own_element, k);
      for (const V3d& corner : patch.corner) box.extendBy(corner);
      axis += patch.centroid().normal * patch.area;
      node.whole_area += patch.area;
    }
    const V3d center = box.center();
    node.center = V3f(center);
    node.axis = V3f(axis.normalized());
    double radius = 0.0;
    for (std::size_t k = 0; k < patches; ++k) {
      const Patch patch = mesh_.patch(node.own_element, k);
      for (const V3d& corner : patch.corner) radius = std::max(radius, (corner - center).length());
      if (patch.area > 0.0)
        node.cone = std::max(node.cone, angle_between(V3f(patch.centroid().normal), node.axis));
    }
    // Pieces of analytic surfaces bulge and turn: an eighth at most.
    const bool bulges = mesh_.is_analytic(mesh_.roots()[node.root].shape);
    node.radius = static_cast<float>(radius * (bulges ? 1.5 : 1.0 + 1e-5));
    if (bulges) node.cone = std::min(pi_f, node.cone + 1.0f);
  }

  // The children of all nodes of the last level. While the tree grows, [begin, end) of a cluster is a range of
  // items.
  void grow_level() {
    throw_if_interrupted();
    std::vector<TreeNode>& nodes = tree_.node_;
    const std::uint32_t first = tree_.level_[tree_.level_.size() - 2], last = tree_.level_.back();
    for (std::uint32_t i = first; i < last; ++i) {
      const auto first_child = static_cast<std::uint32_t>(nodes.size());
      const TreeNode node = nodes[i];
      if (i == 0)
        split_by_direction(node);
      else if (node.kind == TreeNode::cluster)
        halve(node.begin, node.end);
      else if (node.kind == TreeNode::triangle)
        split_triangle(node);
      else if (node.kind == TreeNode::strip)
        split_strip(node);
      const auto end = static_cast<std::uint32_t>(nodes.size());
      nodes[i].first_child = first_child;
      nodes[i].child_count = end - first_child;
      for (std::uint32_t c = first_child; c < end; ++c) nodes[c].parent = i;
    }
    parallel_for(nodes.size() - last, 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = last + begin; k < last + end; ++k)
        if (nodes[k].kind != TreeNode::cluster && !nodes[k].is_patchwork && nodes[k].radius == 0.0f)
          measure(nodes[k], tree_.surface(nodes[k]));
    });
    tree_.level_.push_back(static_cast<std::uint32_t>(nodes.size()));
  }

  // Four triangles of half the size; when that is not a whole number, a strip is left over. What the upright
  // triangle has at the cells (i, j), the inverted one has in point symmetry.
  void split_triangle(const TreeNode& node) {
    const int small = node.size / 2, large = node.size - small, odd = large - small;
    const auto place = [&](int i, int j, int size, bool inverted) {
      if (!node.inverted) return triangle(node.root, node.column + i, node.row + j, size, inverted);
      return triangle(node.root, node.column + node.size - i - size, node.row + node.size - j - size, size,
                      !inverted);
    };
    std::vector<TreeNode>& nodes = tree_.node_;
    nodes.push_back(place(0, 0, large, false));
    nodes.push_back(place(large, 0, small, false));
    nodes.push_back(place(0, large, small, false));
    nodes.push_back(place(odd, 0, small, true));
    if (odd == 0) return;
    nodes.push_back(node.inverted ? strip(node.root, node.column + node.size - small - 1,
                                          node.row + node.size - small - 1, small)
                                  : strip(node.root, node.column, node.row + small, small));
  }

  void split_strip(const TreeNode& node) {
    const int n = node.size, half = n / 2;
    std::vector<TreeNode>& nodes = tree_.node_;
    if (n == 1) {
      nodes.push_back(triangle(node.root, node.column, node.row, 1, true));
      nodes.push_back(triangle(node.root, node.column + 1, node.row, 1, false));
    } else {
      nodes.push_back(strip(node.root, node.column, node.row, half));
      nodes.push_back(strip(node.root, node.column + half, node.row, n - half));
    }
  }

  void split_by_direction(const TreeNode& all) {
    const auto bin = [](const TreeNode& item) { return direction_bin(item.axis); };
    std::stable_sort(items_.begin() + all.begin, items_.begin() + all.end,
                     [&](const TreeNode& a, const TreeNode& b) { return bin(a) < bin(b); });
    for (std::uint32_t b = 0, from = all.begin; b < direction_bins; ++b) {
      std::uint32_t to = from;
      while (to < all.end && bin(items_[to]) == b) ++to;
      if (to > from) add_cluster(from, to);
      from = to;
    }
  }

  // What is much larger than the rest goes by itself, so that it does not blow up every cluster above it;
  // otherwise halves along the longest axis.
  void halve(std::uint32_t begin, std::uint32_t end) {
    const auto first = items_.begin() + begin, last = items_.begin() + end;
    Box3f centers;
    for (auto item = first; item != last; ++item) centers.extendBy(item->center);
    const V3f size = centers.size();
    const float large = 0.5f * max_component(size);
    auto middle = std::stable_partition(first, last, [&](const TreeNode& item) { return item.radius > large; });
    if (middle == first || middle == last) {
      const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
      middle = first + (end - begin) / 2;
      std::nth_element(first, middle, last, [axis](const TreeNode& a, const TreeNode& b) {
        return a.center[axis] != b.center[axis] ? a.center[axis] < b.center[axis] : a.root < b.root;
      });
    }
    const auto split = static_cast<std::uint32_t>(middle - items_.begin());
    add_cluster(begin, split);
    add_cluster(split, end);
  }

  void add_cluster(std::uint32_t begin, std::uint32_t end) {
    if (end - begin == 1) {
      tree_.node_.push_back(items_[begin]);
      return;
    }
    tree_.node_.push_back(cluster(begin, end));
  }

  [[nodiscard]] TreeNode cluster(std::uint32_t begin, std::uint32_t end) const {
    TreeNode node;
    node.begin = begin, node.end = end;
    Box3f box;
    V3d axis(0.0);
    for (std::uint32_t i = begin; i < end; ++i) {
      const TreeNode& item = items_[i];
      box.extendBy(item.center - V3f(item.radius));
      box.extendBy(item.center + V3f(item.radius));
      axis += V3d(item.axis) * item.whole_area;
      node.whole_area += item.whole_area;
    }
    node.center = box.center();
    node.axis = V3f(axis.normalized());
    for (std::uint32_t i = begin; i < end; ++i) {
      const TreeNode& item = items_[i];
      node.radius = std::max(node.radius, (item.center - node.center).length() + item.radius);
      if (item.whole_area > 0.0)
        node.cone = std::max(node.cone, angle_between(item.axis, node.axis) + item.cone);
    }
    return node;
  }

  ElementTree& tree_;
  const ElementMesh& mesh_;
  std::vector<TreeNode> items_;  // what clusters are made of: the roots
};

ElementTree::ElementTree(const ElementMesh& mesh, std::span<const C3f> reflectance) : mesh_(mesh) {
  Builder(*this).run();
  number_elements();
  add_up(reflectance);
}

void ElementTree::number_elements() {
  order_.resize(mesh_.count());
  leaf_.assign(mesh_.count(), no_index);
  // From the leaves up how many, in `end`; and down, which.
  for (TreeNode& node : node_) {
    node.begin = 0;
    node.end = node.kind == TreeNode::element ? 1 : 0;
  }
  for (std::size_t i = node_.size(); i-- > 1;) node_[node_[i].parent].end += node_[i].end;
  for (std::uint32_t i = 0; i < node_.size(); ++i) {
    const TreeNode& node = node_[i];
    if (node.kind == TreeNode::element) {
      order_[node.begin] = element_of_cell(mesh_.roots()[node.root], node);
      leaf_[order_[node.begin]] = i;
    }
    std::uint32_t begin = node.begin;
    for (std::uint32_t c = node.first_child; c < node.first_child + node.child_count; ++c) {
      const std::uint32_t count = node_[c].end;
      node_[c].begin = begin;
      node_[c].end = begin += count;
    }
  }
}

void ElementTree::add_up(std::span<const C3f> reflectance) {
  std::vector<C3d> reflecting(node_.size(), C3d(0.0));  // area x reflectance
  for (TreeNode& node : node_)
    if (node.kind != TreeNode::element) node.whole_area = 0.0;
  for (std::size_t i = node_.size(); i-- > 0;) {
    TreeNode& node = node_[i];
    if (node.kind == TreeNode::element) {
      node.area = mesh_.area(element_of(node));
      reflecting[i] = C3d(reflectance[element_of(node)]) * node.area;
    }
    if (node.area > 0.0) node.reflectance = C3f(reflecting[i] / node.area);
    if (i == 0) continue;
    node_[node.parent].area += node.area;
    node_[node.parent].whole_area += node.whole_area;
    reflecting[node.parent] += reflecting[i];
  }
  area_before_.reserve(order_.size() + 1);
  area_before_.push_back(0.0);
  for (const std::uint32_t e : order_) area_before_.push_back(area_before_.back() + node_[leaf_[e]].whole_area);
}

NodeSurface ElementTree::surface(const TreeNode& node) const {
  NodeSurface surface;
  const ElementRoot& root = mesh_.roots()[node.root];
  if (node.kind == TreeNode::element) {
    surface.patch = mesh_.patch(element_of_cell(root, node));
    surface.polygon = surface.patch.polygon();
    surface.normal = surface.patch.normal;
    surface.offset = surface.patch.offset;
    if (const double flat = polygon_area(surface.polygon); surface.patch.is_analytic() && flat > 0.0)
      surface.area_scale = surface.patch.area / flat;
    return surface;
  }
  const std::array<V2i, 4> grid = grid_corners(node);
  std::array<V3d, 4> corner;
  for (int k = 0; k < 4; ++k) corner[k] = mesh_.grid_point(root, grid[k], root.divisions);
  const Geometry& geometry = mesh_.shapes()[root.shape].geometry;
  if (is_analytic(geometry)) {
    // Of a strip, half: enough to know the points above the polygon.
    surface.patch =
        cell_patch(geometry, root.primitive, {grid[0], grid[1], grid[2]}, root.divisions, root.side);
    surface.offset = surface.patch.offset;
  } else {
    surface.offset = rounding_offset(corners(geometry, root.primitive));
  }
  if (root.side == back) std::swap(corner[1], corner[node.kind == TreeNode::strip ? 3 : 2]);
  surface.polygon = node.kind == TreeNode::strip ? make_polygon(corner[0], corner[1], corner[2], corner[3])
                                                 : make_polygon(corner[0], corner[1], corner[2]);
  const V3d area_vector = polygon_area_vector(surface.polygon);
  const double area = area_vector.length();
  surface.normal = area > 0.0 ? area_vector / area : V3d(0.0);
  Patch& patch = surface.patch;
  if (patch.is_analytic()) {
    if (node.kind == TreeNode::triangle && area > 0.0) surface.area_scale = patch.area / area;
  } else {
    patch.corner = {corner[0], corner[1], corner[2]};
    patch.normal = surface.normal;
    patch.area = area;
    patch.offset = surface.offset;
  }
  return surface;
}

std::array<ElementPoint, 4> ElementTree::points(const TreeNode& node, std::uint32_t key) const {
  const bool has_quarters = node.kind != TreeNode::cluster && !node.is_patchwork &&
                            !(node.kind == TreeNode::strip && is_on_analytic(mesh_, node));
  if (has_quarters) return surface(node).quarters();
  std::array<ElementPoint, 4> point;
  const double before = area_before_[node.begin], area = area_before_[node.end] - before;
  for (std::uint32_t k = 0; k < 4; ++k) {
    Sampler sampler(key, 1, k);
    const double wanted = before + area * (k + static_cast<double>(sampler.next_1d())) / 4.0;
    const auto found =
        std::upper_bound(area_before_.begin() + node.begin + 1, area_before_.begin() + node.end, wanted);
    const auto place = static_cast<std::size_t>(found - area_before_.begin()) - 1;
    point[k] = mesh_.sample(order_[place], sampler.next_2d());
  }
  return point;
}

double ElementTree::form_factor(const std::array<ElementPoint, 4>& from, const TreeNode& leaf) const {
  const std::uint32_t element = element_of(leaf);
  double sum = 0.0;
  for (std::size_t k = 0; k < mesh_.patch_count(element); ++k) {
    const Polygon polygon = mesh_.patch(element, k).polygon();
    for (const ElementPoint& point : from) sum += point_form_factor(point.position, point.normal, polygon);
  }
  return std::min(1.0, 0.25 * sum);
}

double ElementTree::radius_of_common_inside(const TreeNode& a, const TreeNode& b) const {
  if (!is_on_analytic(mesh_, a) || !is_on_analytic(mesh_, b)) return 0.0;
  const ElementRoot &root_a = mesh_.roots()[a.root], &root_b = mesh_.roots()[b.root];
  const auto* sphere = std::get_if<Sphere>(&mesh_.shapes()[root_a.shape].geometry);
  if (!sphere) return 0.0;
  const bool inside = (root_a.side == front) == sphere->inward;
  return root_a.shape == root_b.shape && root_a.side == root_b.side && inside ? double{sphere->radius} : 0.0;
}

std::size_t ElementTree::memory_bytes() const {
  return node_.size() * sizeof(TreeNode) + (order_.size() + leaf_.size()) * sizeof(std::uint32_t) +
         area_before_.size() * sizeof(double);
}

}  // namespace twopass
