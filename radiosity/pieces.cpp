#include "radiosity/pieces.h"

#include "render/core/warp.h"
#include "render/scene/geometry.h"

namespace twopass {

namespace {

using Triangle2 = std::array<V2d, 3>;

// Sums of two terms commute, so the point of an edge is the same bit for bit from both triangles that share it.
// The division is exact at the corners, and common powers of two do not matter.
template <class V>
V grid_point(const std::array<V, 3>& corner, const V2i& numerators, std::uint32_t divisions) {
  const double w1 = numerators.x, w2 = numerators.y, w0 = static_cast<double>(divisions) - w1 - w2;
  return (corner[0] * w0 + corner[1] * w1 + corner[2] * w2) / static_cast<double>(divisions);
}

// Disks: the square that becomes the disk, cut along its diagonals. The first triangle is that around +x.
constexpr std::uint32_t disk_pieces = 4;
bool front_is_clockwise(const Disk& disk) { return disk.reversed; }
Triangle2 parameters(const Disk& disk, std::uint32_t piece) {
  constexpr std::array<std::array<double, 2>, 5> corner{{{1, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
  Triangle2 triangle{V2d(0.0, 0.0), V2d(corner[piece][0], corner[piece][1]),
                     V2d(corner[piece + 1][0], corner[piece + 1][1])};
  if (front_is_clockwise(disk)) std::swap(triangle[1], triangle[2]);
  return triangle;
}

// Cylinders: turns around the axis and the way along it, both from 0 to 1.
constexpr std::uint32_t columns = 8;
std::uint32_t rows_of(const Cylinder& cylinder) {
  const double width = 2.0 * pi * cylinder.radius / columns;
  return static_cast<std::uint32_t>(std::lround(std::clamp(cylinder.length / width, 1.0, 32.0)));
}
bool front_is_clockwise(const Cylinder& cylinder) {
  const bool is_mirrored = cylinder.axes[0].cross(cylinder.axes[1]).dot(cylinder.axes[2]) < 0.0f;
  return cylinder.inward != is_mirrored;
}
Triangle2 parameters(const Cylinder& cylinder, std::uint32_t piece) {
  const std::uint32_t square = piece / 2, rows = rows_of(cylinder);
  const double u0 = static_cast<double>(square % columns) / columns,
               u1 = static_cast<double>(square % columns + 1) / columns,
               v0 = static_cast<double>(square / columns) / rows,
               v1 = static_cast<double>(square / columns + 1) / rows;
  Triangle2 triangle = piece % 2 == 0 ? Triangle2{V2d(u0, v0), V2d(u1, v0), V2d(u0, v1)}
                                      : Triangle2{V2d(u1, v1), V2d(u0, v1), V2d(u1, v0)};
  if (front_is_clockwise(cylinder)) std::swap(triangle[1], triangle[2]);
  return triangle;
}

// Spheres: the octants, by directions from the centre.
bool front_is_clockwise(const Sphere& sphere) { return sphere.inward; }
std::array<V3d, 3> parameters(const Sphere& sphere, std::uint32_t octant) {
  std::array<V3d, 3> corner = octant_corners(octant);
  if (front_is_clockwise(sphere)) std::swap(corner[1], corner[2]);
  return corner;
}

Patch octant_cell(const Sphere& sphere, std::uint32_t octant, const std::array<V2i, 3>& numerators,
                  std::uint32_t divisions, Side side) {
  const std::array<V3d, 3> whole = parameters(sphere, octant);
  std::array<V3d, 3> direction;
  for (int k = 0; k < 3; ++k) direction[k] = grid_point(whole, numerators[k], divisions).normalized();
  if (front_is_clockwise(sphere)) std::swap(direction[1], direction[2]);  // as spherical_patch() wants them
  return spherical_patch(sphere, direction, side);
}

template <class Surface>
Patch parametric_cell(const Surface& surface, std::uint32_t piece, const std::array<V2i, 3>& numerators,
                      std::uint32_t divisions, Side side) {
  const Triangle2 whole = parameters(surface, piece);
  Triangle2 cell;
  for (int k = 0; k < 3; ++k) cell[k] = grid_point(whole, numerators[k], divisions);
  return parametric_patch(surface, cell, side);
}

Patch triangle_cell(const Geometry& mesh, std::uint32_t triangle, const std::array<V2i, 3>& numerators,
                    std::uint32_t divisions, Side side) {
  const Patch whole = triangle_patch(corners(mesh, triangle), front);
  Patch patch;
  patch.offset = whole.offset;
  const V2i a = numerators[1] - numerators[0], b = numerators[2] - numerators[0];
  patch.area = whole.area * std::abs(double(a.x) * b.y - double(a.y) * b.x) / (double(divisions) * divisions);
  patch.normal = side == front ? whole.normal : -whole.normal;
  for (int k = 0; k < 3; ++k) patch.corner[k] = grid_point(whole.corner, numerators[k], divisions);
  if (side == back) std::swap(patch.corner[1], patch.corner[2]);
  return patch;
}

constexpr std::array<V2i, 3> whole_grid{V2i(0, 0), V2i(1, 0), V2i(0, 1)};

}  // namespace

std::size_t piece_count(const Geometry& geometry) {
  if (const Mesh* mesh = mesh_of(geometry)) return mesh->triangles.size();
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry))
    return std::size_t{2} * columns * rows_of(*cylinder);
  return std::holds_alternative<Disk>(geometry) ? disk_pieces : 8;
}

Patch piece_patch(const Geometry& geometry, std::uint32_t piece, Side side) {
  if (!is_analytic(geometry)) return triangle_patch(corners(geometry, piece), side);
  return cell_patch(geometry, piece, whole_grid, 1, side);
}

Patch cell_patch(const Geometry& geometry, std::uint32_t piece, const std::array<V2i, 3>& numerators,
                 std::uint32_t divisions, Side side) {
  if (const auto* sphere = std::get_if<Sphere>(&geometry))
    return octant_cell(*sphere, piece, numerators, divisions, side);
  if (const auto* disk = std::get_if<Disk>(&geometry))
    return parametric_cell(*disk, piece, numerators, divisions, side);
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry))
    return parametric_cell(*cylinder, piece, numerators, divisions, side);
  return triangle_cell(geometry, piece, numerators, divisions, side);
}

V3d piece_grid_point(const Geometry& geometry, std::uint32_t piece, const V2i& numerators,
                     std::uint32_t divisions) {
  if (const auto* sphere = std::get_if<Sphere>(&geometry)) {
    const V3d flat = grid_point(parameters(*sphere, piece), numerators, divisions);
    return V3d(sphere->center) + flat.normalized() * static_cast<double>(sphere->radius);
  }
  if (const auto* disk = std::get_if<Disk>(&geometry))
    return point_of(*disk, grid_point(parameters(*disk, piece), numerators, divisions));
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry))
    return point_of(*cylinder, grid_point(parameters(*cylinder, piece), numerators, divisions));
  const std::array<V3f, 3> p = corners(geometry, piece);
  return grid_point(std::array<V3d, 3>{V3d(p[0]), V3d(p[1]), V3d(p[2])}, numerators, divisions);
}

V3f piece_corner_key(const Geometry& geometry, std::uint32_t piece, int corner) {
  if (const auto* sphere = std::get_if<Sphere>(&geometry)) return V3f(parameters(*sphere, piece)[corner]);
  if (const auto* disk = std::get_if<Disk>(&geometry)) {
    const V2d at = parameters(*disk, piece)[corner];
    return V3f(static_cast<float>(at.x), static_cast<float>(at.y), 0.0f);
  }
  const V2d at = parameters(std::get<Cylinder>(geometry), piece)[corner];
  return V3f(static_cast<float>(at.x - std::floor(at.x)), static_cast<float>(at.y), 0.0f);
}

namespace {

PieceLocation locate(const Sphere& sphere, const V3f& position) {
  const V3f d = position - sphere.center;
  const std::uint32_t octant = (d.x < 0.0f ? 1u : 0u) | (d.y < 0.0f ? 2u : 0u) | (d.z < 0.0f ? 4u : 0u);
  const V3f a(std::abs(d.x), std::abs(d.y), std::abs(d.z));
  const float sum = a.x + a.y + a.z;
  const float u = sum > 0.0f ? a.y / sum : 0.0f, v = sum > 0.0f ? a.z / sum : 0.0f;
  // An odd number of signs: octant_corners has exchanged the last two.
  const bool is_exchanged = octant == 1 || octant == 2 || octant == 4 || octant == 7;
  return is_exchanged != front_is_clockwise(sphere) ? PieceLocation{octant, v, u} : PieceLocation{octant, u, v};
}

PieceLocation locate(const Disk& disk, const V3f& position) {
  // Radius and angle; the quarter of the disk and where in it, in units of an eighth of a turn.
  const V3d x(disk.x), y(disk.y), p = V3d(position) - V3d(disk.center), normal = x.cross(y);
  const double n2 = normal.dot(normal), a = normal.dot(p.cross(y)) / n2, b = normal.dot(x.cross(p)) / n2;
  const double radius = std::hypot(a, b);
  double eighths = std::atan2(b, a) / (pi / 4);
  if (eighths < -1.0) eighths += 8.0;
  const int quarter = std::clamp(static_cast<int>((eighths + 1.0) / 2.0), 0, 3);
  const double across = std::clamp(eighths - 2.0 * quarter, -1.0, 1.0);
  const auto u = static_cast<float>(radius * (1.0 - across) / 2.0),
             v = static_cast<float>(radius * (1.0 + across) / 2.0);
  const auto piece = static_cast<std::uint32_t>(quarter);
  return front_is_clockwise(disk) ? PieceLocation{piece, v, u} : PieceLocation{piece, u, v};
}

PieceLocation locate(const Cylinder& cylinder, const V3f& position) {
  float along;
  const V3f outward = outward_at(cylinder, position, along);
  const float turns = std::atan2(outward.dot(cylinder.axes[1]), outward.dot(cylinder.axes[0])) / (2.0f * pi_f);
  const std::uint32_t rows = rows_of(cylinder);
  const float x = (turns < 0.0f ? turns + 1.0f : turns) * static_cast<float>(columns),
              y = along * static_cast<float>(rows);
  const std::uint32_t column = std::min(static_cast<std::uint32_t>(x), columns - 1),
                      row = std::min(static_cast<std::uint32_t>(y), rows - 1);
  float u = x - static_cast<float>(column), v = y - static_cast<float>(row);
  std::uint32_t piece = 2 * (row * columns + column);
  if (u + v > 1.0f) {
    ++piece;
    u = 1.0f - u, v = 1.0f - v;
  }
  return front_is_clockwise(cylinder) ? PieceLocation{piece, v, u} : PieceLocation{piece, u, v};
}

}  // namespace

PieceLocation locate_piece(const Geometry& geometry, const V3f& position) {
  if (const auto* sphere = std::get_if<Sphere>(&geometry)) return locate(*sphere, position);
  if (const auto* disk = std::get_if<Disk>(&geometry)) return locate(*disk, position);
  return locate(std::get<Cylinder>(geometry), position);
}

}  // namespace twopass
