// Polygons in space to triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/core/types.h"

namespace twopass {

/// Cuts a polygon of n >= 3 corners into n - 2 triangles of the same orientation, as indices into `corners`.
/// Convex polygons become a fan from corner 0 (as in Mitsuba); concave ones lose one ear at a time. Slightly
/// bent polygons are cut in the projection along their mean normal. Self-intersecting ones come out as some set
/// of n - 2 triangles: there is no right answer, but always an answer.
std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const V3f> corners);

}  // namespace twopass
