// The surfaces divided into elements. Elements are arithmetic on the input triangles' barycentric coordinates:
// the ray caster never sees them, so they cost no geometry and cannot crack.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "radiosity/pieces.h"
#include "render/scene/ray.h"
#include "render/scene/shape.h"

namespace twopass {

/// The side of a triangle, or of a piece of an analytic surface (pieces.h). Either it is cut into divisions^2
/// cells by lines parallel to its edges, each cell perhaps again into four, and so on (on a sphere: the flat
/// triangle below the octant, projected from the centre, so that edges are great circles; on disks and
/// cylinders: the triangle of parameters, so that cells are of equal area); or it is smaller than an element
/// and part of a cluster.
struct ElementRoot {
  std::uint32_t shape;
  std::uint32_t primitive;  ///< triangle of the mesh; piece of the analytic surface
  std::uint32_t
      first_element;         ///< its elements follow each other; of a part of a cluster: the cluster's element
  std::uint32_t first_cell;  ///< where its quad-trees start; no_index: every cell is an element
  std::uint16_t divisions;   ///< of each edge; 0: part of a cluster
  Side side;
};

/// A piece of a root: the small triangle at (column, row) of the grid along corners 1 and 2, or the one upside
/// down beside it.
struct ElementCell {
  std::uint32_t column, row;
  bool inverted;
  std::uint32_t divisions;  ///< of the root's edges in this cell's grid: the root's own times a power of two
};

/// The corners of a cell on its grid: numerators of the barycentric coordinates of corners 1 and 2 over
/// `divisions`, counter-clockwise seen from the root's front.
std::array<V2i, 3> cell_corners(const ElementCell& cell);
/// A quarter of a cell: beside corner 0, 1, 2, or the one in the middle, 3, whose corner k lies between the
/// other two corners.
ElementCell child_cell(const ElementCell& cell, int child);

/// The albedo that stands in for 1 and more: with them the balance of a closed scene has no solution.
inline constexpr float largest_reflectance = 0.999f;

/// All elements of a scene. REQUIRES: shapes and materials outlive it.
class ElementMesh {
 public:
  ElementMesh() = default;
  /// Numbers the elements of the roots and measures them; `first_element` and `first_cell` of the given roots
  /// are not read, and a root of no divisions belongs to the cluster of its place in `cluster_of_root`.
  /// REQUIRES: roots in the order of shape, side, primitive; for a side of a shape, all its primitives or none;
  /// `cluster_of_root` empty or one entry a root, clusters numbered without gaps, of one material and side
  /// each.
  ElementMesh(std::span<const Shape> shapes, std::span<const Material> materials,
              std::vector<ElementRoot> roots, std::span<const std::uint32_t> cluster_of_root = {});

  /// What the mesh is beyond its scene, as plain data to be stored.
  struct Saved {
    std::vector<std::uint32_t> surface;    ///< shape x 2 + side, ascending: those whose primitives are roots
    std::vector<std::uint16_t> divisions;  ///< by root
    std::vector<std::uint32_t> cluster;    ///< by root of no divisions
    std::vector<std::uint8_t> level;       ///< by element but clusters: how often split; empty: none is
    std::vector<float> area;               ///< by element: exposed
  };
  [[nodiscard]] Saved save() const;
  /// The same mesh again, bit for bit; none if what was saved cannot be a mesh of these shapes, whatever it is.
  [[nodiscard]] static std::optional<ElementMesh> restore(std::span<const Shape> shapes,
                                                          std::span<const Material> materials,
                                                          const Saved& saved);

  /// The same with the chosen elements cut into four, or as far as that is possible: cells of the finest grid
  /// and clusters stay as they are. REQUIRES: one flag an element. The new elements are wholly exposed.
  [[nodiscard]] ElementMesh split(const std::vector<bool>& chosen) const;
  /// The same with each element cut so many times into four.
  [[nodiscard]] ElementMesh cut(std::span<const std::uint8_t> times) const;

  /// An element, and where in it: barycentric coordinates of its corners 1 and 2 in the order of
  /// `cell_corners`; in a cluster, those of the triangle that was hit.
  struct Location {
    std::uint32_t element;
    std::uint32_t root;  ///< index into roots() of the triangle that was hit
    float u, v;
  };

  /// Where rays meet a cell, by its sixteenths: the number 4 i + j is the quarter j of its quarter i
  /// (child_cell).
  struct Weights {
    std::array<std::uint8_t, 16> count{};  ///< in proportion
    /// One of the places, where the count is not 0: coordinates in the sixteenth, as of a Location, from 0 to
    /// 255.
    std::array<std::array<std::uint8_t, 2>, 16> place{};
    /// A place as it is kept, to half a 255th.
    static std::array<std::uint8_t, 2> packed(float u, float v);
    bool operator==(const Weights&) const = default;
  };
  /// From now on points are drawn from these places by their counts: what an element sees and sends is that of
  /// where rays from afar meet it (R48). Counts of 0: uniformly. REQUIRES: one entry a cell, in the order of
  /// elements.
  void weigh(std::vector<Weights> weights) { weights_ = std::move(weights); }
  /// As weigh() was told; empty: all points are drawn uniformly.
  [[nodiscard]] const std::vector<Weights>& weights() const { return weights_; }
  /// A place in a cell: the number of the sixteenth, and where in that, as Location says.
  struct Sixteenth {
    std::uint32_t number;
    float u, v;
  };
  /// REQUIRES: the place is not in a cluster.
  [[nodiscard]] static Sixteenth sixteenth_at(const Location& location);

  [[nodiscard]] std::size_t count() const { return place_.size(); }

  /// The element of a point on the viewer's side, or no_index.
  [[nodiscard]] std::uint32_t find(const SurfacePoint& point) const { return locate(point).element; }
  /// As `find`, and where in the element.
  [[nodiscard]] Location locate(const SurfacePoint& point) const {
    const std::uint32_t base = first_root_[point.shape][point.side];
    if (base == no_index) return {no_index, no_index, 0.0f, 0.0f};
    if (is_analytic_[point.shape]) return find_on_surface(base, point);
    return find_in_root(base + point.primitive, point.u, point.v);
  }
  [[nodiscard]] bool is_analytic(std::uint32_t shape) const { return is_analytic_[shape] != 0; }
  /// True if that side of the shape has elements.
  [[nodiscard]] bool has_elements(std::uint32_t shape, Side side) const {
    return first_root_[shape][side] != no_index;
  }

  /// Leaves only this fraction of each element's area: the rest is buried under other surfaces and plays no
  /// part. An element of fraction 0 is as good as none.
  void expose(std::span<const float> fraction);
  /// Area of the exposed part of the true surface (of analytic ones, too).
  [[nodiscard]] double area(std::uint32_t element) const { return area_[element]; }
  /// sqrt(area).
  [[nodiscard]] float size(std::uint32_t element) const { return std::sqrt(area_[element]); }
  /// Mean albedo of the diffuse part over the element, in [0, 1].
  [[nodiscard]] const C3f& reflectance(std::uint32_t element) const { return reflectance_[element]; }

  /// How many elements are clusters: the last ones.
  [[nodiscard]] std::size_t cluster_count() const {
    return first_member_.empty() ? 0 : first_member_.size() - 1;
  }
  /// Whether the element is a set of small triangles rather than one piece.
  [[nodiscard]] bool is_cluster(std::uint32_t element) const { return root(element).divisions == 0; }
  /// Whether it is a cell on which points are drawn uniformly.
  [[nodiscard]] bool is_even_cell(std::uint32_t element) const {
    return !is_cluster(element) && (weights_.empty() || weights_[element] == Weights{});
  }
  /// How many patches the element has; 1 unless it is a cluster.
  [[nodiscard]] std::size_t patch_count(std::uint32_t element) const {
    return is_cluster(element) ? members(element).size() : 1;
  }
  /// The whole element, or the k-th triangle of a cluster. REQUIRES: k < patch_count(element).
  [[nodiscard]] Patch patch(std::uint32_t element, std::size_t k = 0) const;
  /// Area of the true surface, buried parts included.
  [[nodiscard]] double whole_area(std::uint32_t element) const;
  /// A point uniform in area, or one of weigh()'s, for u uniform in the unit square.
  [[nodiscard]] ElementPoint sample(std::uint32_t element, const V2f& u) const;

  /// A point in the middle; of a cluster, in a triangle near the middle of its list.
  [[nodiscard]] ElementPoint centroid(std::uint32_t element) const {
    return is_cluster(element) ? sample(element, V2f(0.5f)) : patch(element).centroid();
  }

  /// The point of a root's grid, with numerators as `cell_corners` gives them. Neighbouring triangles with
  /// equal vertices get equal points on their common edge, bit for bit, whatever their grids.
  [[nodiscard]] V3d grid_point(const ElementRoot& root, const V2i& numerators, std::uint32_t divisions) const;

  [[nodiscard]] std::span<const ElementRoot> roots() const { return roots_; }
  /// Of a cluster: its first.
  [[nodiscard]] const ElementRoot& root(std::uint32_t element) const { return roots_[place_[element].root]; }
  [[nodiscard]] std::uint32_t root_index(std::uint32_t element) const { return place_[element].root; }
  /// The roots of a cluster, by index into roots().
  [[nodiscard]] std::span<const std::uint32_t> members(std::uint32_t cluster_element) const;
  /// REQUIRES: !is_cluster(element).
  [[nodiscard]] ElementCell cell(std::uint32_t element) const;
  [[nodiscard]] std::span<const Shape> shapes() const { return shapes_; }
  /// Of the elements: what an element takes beyond the scene, 24 bytes and 48 where
  /// cells are weighted, and 20 for each triangle side.
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  // Where an element is: its root, and the cell on it, or the number of the cluster.
  struct Place {
    std::uint32_t root;
    std::uint32_t cell;  // packed; or the index of the cluster
  };
  void number_elements(std::span<const std::uint32_t> cluster_of_root);
  void add_clusters(std::span<const std::uint32_t> cluster_of_root);
  [[nodiscard]] bool refine(const std::vector<std::uint8_t>& level);
  void index_cells();
  void measure();
  void find_reflectances();
  [[nodiscard]] Location find_in_root(std::uint32_t root_index, float u, float v) const;
  [[nodiscard]] Location find_on_surface(std::uint32_t base, const SurfacePoint& point) const;
  [[nodiscard]] Patch root_patch(const ElementRoot& root) const;
  [[nodiscard]] Patch cell_patch(const ElementRoot& root, const ElementCell& cell) const;

  std::span<const Shape> shapes_;
  std::span<const Material> materials_;
  std::vector<std::array<std::uint32_t, 2>> first_root_;  // by shape and side; no_index: no elements
  std::vector<std::uint8_t> is_analytic_;                 // by shape
  std::vector<ElementRoot> roots_;
  std::vector<std::uint32_t> cells_;  // of refined roots: an element, or the first of four cells | refined
  std::vector<std::uint32_t> first_member_;  // by cluster, and the end
  std::vector<std::uint32_t> member_;        // roots, by cluster
  std::vector<float> member_share_;          // by member: the part of the cluster's area up to and with it
  std::vector<Place> place_;                 // by element
  std::vector<float> area_;                  // by element
  std::vector<C3f> reflectance_;             // by element
  std::vector<Weights> weights_;             // by cell, or empty
};

/// Points of one element, many times: finds out once what they have in common. REQUIRES: the mesh outlives it.
class ElementSampler {
 public:
  ElementSampler(const ElementMesh& mesh, std::uint32_t element)
      : mesh_(mesh),
        element_(element),
        patch_(mesh.patch(element)),
        is_even_cell_(mesh.is_even_cell(element)) {}
  /// As ElementMesh::sample().
  [[nodiscard]] ElementPoint operator()(const V2f& u) const {
    return is_even_cell_ ? patch_.sample(u) : mesh_.sample(element_, u);
  }

 private:
  const ElementMesh& mesh_;
  std::uint32_t element_;
  Patch patch_;
  bool is_even_cell_;
};

}  // namespace twopass
