// The elements as the leaves of a tree: quad-trees on the input triangles, clusters of triangles above them.
#pragma once

#include <span>
#include <vector>

#include "radiosity/elements.h"

namespace twopass {

/// A set of elements that lie near each other and face about the same way.
struct TreeNode {
  enum Kind : std::uint8_t {
    cluster,   ///< of pieces of surface that are not one grid
    triangle,  ///< of the grid of a root: size^2 elements; upside down if `inverted`
    strip,     ///< one row of such a grid: the parallelogram of `size` pairs of elements, inverted and upright
    element,
  };

  std::uint32_t parent = no_index;
  std::uint32_t first_child = 0, child_count = 0;  ///< children follow each other
  std::uint32_t begin = 0, end = 0;                ///< its elements: this range of ElementTree::order()
  std::uint32_t root = no_index;                   ///< of ElementMesh::roots(); not for clusters
  std::uint16_t column = 0, row = 0;  ///< of the first cell of the box in the root's grid that bounds it
  std::uint16_t size = 1;             ///< in cells
  bool inverted = false;
  Kind kind = cluster;
  bool is_flat = false;                  ///< a polygon
  bool is_patchwork = false;             ///< an element of many small triangles
  std::uint32_t own_element = no_index;  ///< of elements that are not just a cell of their root's grid
  V3f center{0.0f};                      ///< of a sphere around all of it
  float radius = 0.0f;
  V3f axis{0.0f};           ///< about which the normals lie; unit, zero if there is no area at all
  float cone = 0.0f;        ///< largest angle between a normal and the axis, radians
  C3f reflectance{0.0f};    ///< mean over the exposed area
  double area = 0.0;        ///< exposed
  double whole_area = 0.0;  ///< with what is buried
};

/// The surface of a triangle, a strip or an element: a polygon, or a piece of an analytic surface.
struct NodeSurface {
  Polygon polygon;          ///< flat; counter-clockwise seen from the node's side
  V3d normal{0.0};          ///< of the polygon
  float offset = 0.0f;      ///< as in ElementPoint
  double area_scale = 1.0;  ///< area of the true surface over that of the polygon
  Patch patch;              ///< of triangles and elements

  /// Point uniform in area of the true surface for u uniform in the unit square. REQUIRES: flat, or an element.
  [[nodiscard]] ElementPoint sample(const V2f& u) const;
  /// The middles of its four quarters.
  [[nodiscard]] std::array<ElementPoint, 4> quarters() const;
};

/// Node 0 is the whole scene; its children are clusters of elements that face one of 26 directions each.
/// Parents come before their children. Const once built. REQUIRES: the mesh outlives it.
class ElementTree {
 public:
  /// Built in O(n log n). `reflectance`: by element.
  ElementTree(const ElementMesh& mesh, std::span<const C3f> reflectance);

  [[nodiscard]] std::span<const TreeNode> nodes() const { return node_; }
  [[nodiscard]] const TreeNode& node(std::uint32_t index) const { return node_[index]; }
  /// The elements, sorted so that those of a node follow each other.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return order_; }
  /// The element of a leaf.
  [[nodiscard]] std::uint32_t element_of(const TreeNode& leaf) const { return order_[leaf.begin]; }
  /// The leaf of an element.
  [[nodiscard]] std::uint32_t leaf_of(std::uint32_t element) const { return leaf_[element]; }
  /// First node of each level and the number of nodes: children of a level's nodes are on the next.
  [[nodiscard]] std::span<const std::uint32_t> levels() const { return level_; }

  /// The geometry of a node that is no cluster.
  [[nodiscard]] NodeSurface surface(const TreeNode& node) const;
  /// Four points of a node that stand for a quarter of its area each: the middles of the quarters of polygons
  /// and spherical triangles, random points (a pure function of `key`) elsewhere.
  [[nodiscard]] std::array<ElementPoint, 4> points(const TreeNode& node, std::uint32_t key) const;
  /// Mean form factor of the points to all triangles of an element, by (R2), without obstacles.
  [[nodiscard]] double form_factor(const std::array<ElementPoint, 4>& from, const TreeNode& leaf) const;
  /// Radius of the sphere of which both nodes are inner pieces, so that the kernel is constant between them; 0
  /// if there is none.
  [[nodiscard]] double radius_of_common_inside(const TreeNode& a, const TreeNode& b) const;

  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  class Builder;

  void number_elements();
  void add_up(std::span<const C3f> reflectance);

  const ElementMesh& mesh_;
  std::vector<TreeNode> node_;
  std::vector<std::uint32_t> order_, leaf_, level_;
  std::vector<double> area_before_;  // by place in the order: whole area of all elements before it
};

}  // namespace twopass
