// Every shape as triangular pieces, on which elements are grids: the triangles of meshes, octants of spheres,
// quarters of disks, and squares cut in two of cylinders, which are triangles of a plane of parameters.
#pragma once

#include <array>

#include "radiosity/patch.h"
#include "render/scene/shape.h"

namespace twopass {

/// Whether the true surface is not the flat triangles between the corners of its pieces.
inline bool is_analytic(const Geometry& geometry) {
  return !std::holds_alternative<Mesh>(geometry) && !std::holds_alternative<MeshInstance>(geometry);
}

/// How many pieces there are: triangles; 8 octants; 4 quarters; of a cylinder 8 squares around it, cut in two,
/// in as many rows as make them about square, at most 32.
std::size_t piece_count(const Geometry& geometry);

/// A side of a piece, and of a part of it: between the points of its grid that have these numerators of the
/// barycentric coordinates of corners 1 and 2 over `divisions`, counter-clockwise seen from the piece's front.
/// REQUIRES: the shape outlives the patch.
Patch piece_patch(const Geometry& geometry, std::uint32_t piece, Side side);
Patch cell_patch(const Geometry& geometry, std::uint32_t piece, const std::array<V2i, 3>& numerators,
                 std::uint32_t divisions, Side side);

/// The point of a piece's grid. Neighbouring pieces with equal vertices get equal points on their common edge,
/// bit for bit, whatever their grids.
V3d piece_grid_point(const Geometry& geometry, std::uint32_t piece, const V2i& numerators,
                     std::uint32_t divisions);

/// A corner of a piece of an analytic surface: equal, bit for bit, where pieces of that surface meet, and only
/// there. Not a place in the world.
V3f piece_corner_key(const Geometry& geometry, std::uint32_t piece, int corner);

/// The piece of an analytic surface on which a point lies, and its barycentric coordinates of corners 1 and 2.
struct PieceLocation {
  std::uint32_t piece;
  float u, v;
};
PieceLocation locate_piece(const Geometry& geometry, const V3f& position);

}  // namespace twopass
