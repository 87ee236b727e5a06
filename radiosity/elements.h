// The surfaces divided into elements. Elements are arithmetic on the input triangles' barycentric coordinates:
// the ray caster never sees them, so they cost no geometry and cannot crack.
#pragma once

#include <span>
#include <vector>

#include "radiosity/patch.h"
#include "render/scene/ray.h"
#include "render/scene/shape.h"

namespace twopass {

/// The side of a triangle, or of an octant of a sphere, cut into divisions^2 elements by lines parallel to its
/// edges. (On a sphere: of the flat triangle below the octant, projected from the centre, so that edges are
/// great circles.)
struct ElementRoot {
  std::uint32_t shape;
  std::uint32_t primitive;      ///< triangle of the mesh; octant of the sphere
  std::uint32_t first_element;  ///< its elements follow each other
  std::uint16_t divisions;      ///< of each edge; >= 1
  Side side;
};

/// Which piece of its root an element is: the small triangle at (column, row) of the grid along corners 1 and
/// 2, or the one upside down beside it.
struct ElementCell {
  std::uint32_t column, row;
  bool inverted;
};

/// The corners of a cell on the root's grid: numerators of the barycentric coordinates of corners 1 and 2 over
/// `divisions`, counter-clockwise seen from the root's front.
std::array<V2i, 3> cell_corners(const ElementCell& cell);

/// The albedo that stands in for 1 and more: with them the balance of a closed scene has no solution.
inline constexpr float largest_reflectance = 0.999f;

/// All elements of a scene, and the way from a point of a surface to its element. REQUIRES: the shapes outlive
/// it.
class ElementMesh {
 public:
  ElementMesh() = default;
  /// Numbers the elements of the roots and measures them; `first_element` of the given roots is not read.
  /// REQUIRES: roots in the order of shape, side, primitive; for a side of a shape, all its primitives or none.
  ElementMesh(std::span<const Shape> shapes, std::span<const Material> materials,
              std::vector<ElementRoot> roots);

  [[nodiscard]] std::size_t count() const { return area_.size(); }

  /// The element of a point on the viewer's side, or no_index.
  [[nodiscard]] std::uint32_t find(const SurfacePoint& point) const {
    const std::uint32_t base = first_root_[point.shape][point.side];
    if (base == no_index) return no_index;
    if (is_sphere_[point.shape]) return find_on_sphere(base, point.position).element;
    return find_in_root(base + point.primitive, point.u, point.v).element;
  }
  /// An element, and where in it: barycentric coordinates of its corners 1 and 2 in the order of
  /// `cell_corners`.
  struct Location {
    std::uint32_t element;
    float u, v;
  };
  /// As `find`, and where in the element.
  [[nodiscard]] Location locate(const SurfacePoint& point) const;
  [[nodiscard]] bool is_sphere(std::uint32_t shape) const { return is_sphere_[shape] != 0; }
  /// True if that side of the shape has elements.
  [[nodiscard]] bool has_elements(std::uint32_t shape, Side side) const {
    return first_root_[shape][side] != no_index;
  }

  /// Leaves only this fraction of each element's area: the rest is buried under other surfaces and plays no
  /// part. An element of fraction 0 is as good as none.
  void expose(std::span<const double> fraction);
  /// Area of the exposed part of the true surface (on a sphere of the spherical triangle).
  [[nodiscard]] double area(std::uint32_t element) const { return area_[element]; }
  /// sqrt(area).
  [[nodiscard]] float size(std::uint32_t element) const {
    return std::sqrt(static_cast<float>(area_[element]));
  }
  /// Albedo of the diffuse part, in [0, 1].
  [[nodiscard]] const C3f& reflectance(std::uint32_t element) const { return reflectance_[element]; }
  [[nodiscard]] Patch patch(std::uint32_t element) const;
  /// The point of a root's grid, with numerators as `cell_corners` gives them. Neighbouring triangles with
  /// equal vertices get equal points on their common edge, bit for bit.
  [[nodiscard]] V3d grid_point(const ElementRoot& root, const V2i& numerators) const;

  [[nodiscard]] std::span<const ElementRoot> roots() const { return roots_; }
  [[nodiscard]] const ElementRoot& root(std::uint32_t element) const { return roots_[root_of_[element]]; }
  [[nodiscard]] ElementCell cell(std::uint32_t element) const;
  [[nodiscard]] std::span<const Shape> shapes() const { return shapes_; }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  [[nodiscard]] Location find_in_root(std::uint32_t root, float u, float v) const;
  [[nodiscard]] Location find_on_sphere(std::uint32_t base, const V3f& position) const;

  std::span<const Shape> shapes_;
  std::vector<std::array<std::uint32_t, 2>> first_root_;  // by shape and side; no_index: no elements
  std::vector<std::uint8_t> is_sphere_;                   // by shape
  std::vector<V3f> sphere_center_;                        // by shape
  std::vector<ElementRoot> roots_;
  std::vector<std::uint32_t> root_of_;  // by element
  std::vector<double> area_;            // by element
  std::vector<C3f> reflectance_;        // by element
};

}  // namespace twopass
