// What loaders do to a mesh between reading and handing it over.
#pragma once

#include <string_view>

#include "render/core/types.h"
#include "render/scene/shape.h"

namespace twopass {

/// Coordinates beyond this are refused: products of three of them would overflow in float.
inline constexpr double largest_coordinate = 1e12;

/// Positions by `to_world` (row vectors), normals by its inverse transpose; computed in double, rounded to
/// float. Does not change the winding. Throws Error at `where` when a position is no longer finite or exceeds
/// largest_coordinate.
void transform(Mesh& mesh, const M44d& to_world, std::string_view where);

/// Whether the matrix turns right hands into left hands, so that the winding of a mesh has to be reversed to
/// keep its front.
bool is_mirroring(const M44d& matrix);

/// Turns the mesh inside out: winding and shading normals.
void flip(Mesh& mesh);
/// Reverses the winding alone.
void reverse_winding(Mesh& mesh);

/// Removes triangles that have no area, and positions that no triangle uses. Returns the number of triangles
/// removed.
std::size_t drop_degenerate_triangles(Mesh& mesh);

/// Shading normals from the triangles around each position, weighted by their angles there.
void compute_smooth_normals(Mesh& mesh);

/// Reverses the triangles that face away from their own shading normals: a file's normals say more reliably
/// than its winding where the outside is. Returns how many.
std::size_t orient_by_normals(Mesh& mesh);

/// Removes shading normals that are those of the flat triangles anyway.
void drop_flat_normals(Mesh& mesh);

}  // namespace twopass
