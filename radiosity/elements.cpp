#include "radiosity/elements.h"

namespace twopass {

namespace {

// Sums of two terms commute, so the point of an edge is the same bit for bit from both triangles that share it.
// The division is exact at the corners.
V3d flat_grid_point(const std::array<V3d, 3>& corner, const V2i& cell_corner, int divisions) {
  const double w0 = divisions - cell_corner.x - cell_corner.y, w1 = cell_corner.x, w2 = cell_corner.y;
  return (corner[0] * w0 + corner[1] * w1 + corner[2] * w2) / static_cast<double>(divisions);
}

std::size_t cell_count(const ElementRoot& root) { return std::size_t{root.divisions} * root.divisions; }

// Cells are numbered row by row; a row holds 2 (divisions - row) - 1 of them.
std::uint32_t cell_index(std::uint32_t column, std::uint32_t row, bool inverted, std::uint32_t divisions) {
  return row * (2 * divisions - row) + 2 * column + (inverted ? 1 : 0);
}

}  // namespace

std::array<V2i, 3> cell_corners(const ElementCell& cell) {
  const V2i p(static_cast<int>(cell.column), static_cast<int>(cell.row));
  if (cell.inverted) return {p + V2i(1, 1), p + V2i(0, 1), p + V2i(1, 0)};
  return {p, p + V2i(1, 0), p + V2i(0, 1)};
}

ElementMesh::ElementMesh(std::span<const Shape> shapes, std::span<const Material> materials,
                         std::vector<ElementRoot> roots)
    : shapes_(shapes),
      first_root_(shapes.size(), {no_index, no_index}),
      is_sphere_(shapes.size(), 0),
      sphere_center_(shapes.size(), V3f(0.0f)),
      roots_(std::move(roots)) {
  for (std::size_t s = 0; s < shapes.size(); ++s)
    if (const auto* sphere = std::get_if<Sphere>(&shapes[s].geometry)) {
      is_sphere_[s] = 1;
      sphere_center_[s] = sphere->center;
    }
  std::size_t total = 0;
  for (const ElementRoot& root : roots_) total += cell_count(root);
  root_of_.reserve(total);
  reflectance_.reserve(total);
  for (std::uint32_t r = 0; r < roots_.size(); ++r) {
    ElementRoot& root = roots_[r];
    std::uint32_t& base = first_root_[root.shape][root.side];
    if (base == no_index) base = r;
    root.first_element = static_cast<std::uint32_t>(root_of_.size());
    root_of_.insert(root_of_.end(), cell_count(root), r);
    const Bsdf& bsdf = materials[shapes_[root.shape].material].side[root.side];
    reflectance_.insert(reflectance_.end(), cell_count(root), diffuse_reflectance(bsdf));
  }
  area_.resize(root_of_.size());
  for (std::uint32_t element = 0; element < area_.size(); ++element) area_[element] = patch(element).area;
}

ElementMesh::Location ElementMesh::locate(const SurfacePoint& point) const {
  const std::uint32_t base = first_root_[point.shape][point.side];
  if (base == no_index) return {no_index, 0.0f, 0.0f};
  if (is_sphere_[point.shape]) return find_on_sphere(base, point.position);
  return find_in_root(base + point.primitive, point.u, point.v);
}

ElementMesh::Location ElementMesh::find_in_root(std::uint32_t root_index, float u, float v) const {
  const ElementRoot& root = roots_[root_index];
  const auto divisions = static_cast<std::int32_t>(root.divisions);
  const float x = std::clamp(u, 0.0f, 1.0f) * static_cast<float>(divisions);
  const float y = std::clamp(v, 0.0f, 1.0f) * static_cast<float>(divisions);
  const std::int32_t row = std::min(static_cast<std::int32_t>(y), divisions - 1);
  const std::int32_t column = std::min(static_cast<std::int32_t>(x), divisions - 1 - row);
  const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
  // The last cell of a row has no partner: rounding beyond the third edge stays in it.
  const bool inverted = fx + fy > 1.0f && column + row < divisions - 1;
  const std::uint32_t cell = cell_index(static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row),
                                        inverted, static_cast<std::uint32_t>(divisions));
  return {root.first_element + cell, inverted ? 1.0f - fx : fx, inverted ? 1.0f - fy : fy};
}

ElementMesh::Location ElementMesh::find_on_sphere(std::uint32_t base, const V3f& position) const {
  const V3f d = position - sphere_center_[roots_[base].shape];
  const std::uint32_t octant = (d.x < 0.0f ? 1u : 0u) | (d.y < 0.0f ? 2u : 0u) | (d.z < 0.0f ? 4u : 0u);
  const V3f a(std::abs(d.x), std::abs(d.y), std::abs(d.z));
  const float sum = a.x + a.y + a.z;
  float u = sum > 0.0f ? a.y / sum : 0.0f, v = sum > 0.0f ? a.z / sum : 0.0f;
  // An odd number of signs: octant_corners has exchanged the last two.
  if (octant == 1 || octant == 2 || octant == 4 || octant == 7) std::swap(u, v);
  return find_in_root(base + octant, u, v);
}

ElementCell ElementMesh::cell(std::uint32_t element) const {
  const ElementRoot& r = root(element);
  const std::uint32_t index = element - r.first_element, divisions = r.divisions;
  // The cells of this row and those after it are the largest square that holds them.
  std::uint32_t row =
      divisions - static_cast<std::uint32_t>(std::ceil(std::sqrt(double(divisions) * divisions - index)));
  while (row > 0 && cell_index(0, row, false, divisions) > index) --row;
  while (row + 1 < divisions && cell_index(0, row + 1, false, divisions) <= index) ++row;
  const std::uint32_t in_row = index - cell_index(0, row, false, divisions);
  return {in_row / 2, row, in_row % 2 == 1};
}

V3d ElementMesh::grid_point(const ElementRoot& root, const V2i& numerators) const {
  const Shape& shape = shapes_[root.shape];
  if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
    const V3d flat = flat_grid_point(octant_corners(root.primitive), numerators, root.divisions);
    return V3d(sphere->center) + flat.normalized() * static_cast<double>(sphere->radius);
  }
  const Patch whole = triangle_patch(std::get<Mesh>(shape.geometry), root.primitive, front);
  return flat_grid_point(whole.corner, numerators, root.divisions);
}

Patch ElementMesh::patch(std::uint32_t element) const {
  const ElementRoot& r = root(element);
  const std::array<V2i, 3> grid = cell_corners(cell(element));
  const Shape& shape = shapes_[r.shape];
  if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
    const std::array<V3d, 3> octant = octant_corners(r.primitive);
    std::array<V3d, 3> direction;
    for (int k = 0; k < 3; ++k) direction[k] = flat_grid_point(octant, grid[k], r.divisions).normalized();
    return spherical_patch(*sphere, direction, r.side);
  }
  Patch patch;
  const Patch whole = triangle_patch(std::get<Mesh>(shape.geometry), r.primitive, front);
  patch.offset = whole.offset;
  patch.area = whole.area / (double(r.divisions) * r.divisions);
  patch.normal = r.side == front ? whole.normal : -whole.normal;
  for (int k = 0; k < 3; ++k) patch.corner[k] = flat_grid_point(whole.corner, grid[k], r.divisions);
  if (r.side == back) std::swap(patch.corner[1], patch.corner[2]);
  return patch;
}

void ElementMesh::expose(std::span<const double> fraction) {
  for (std::size_t i = 0; i < area_.size(); ++i) area_[i] *= fraction[i];
}

std::size_t ElementMesh::memory_bytes() const {
  return roots_.size() * sizeof(ElementRoot) + first_root_.size() * sizeof(first_root_[0]) +
         count() * (sizeof(std::uint32_t) + sizeof(double) + sizeof(C3f));
}

}  // namespace twopass
