// How finely each surface is divided into elements.
#pragma once

#include "radiosity/elements.h"
#include "render/scene/scene.h"

namespace twopass {

/// True if that side of the shape can hold a radiosity: its model is not purely specular and has a diffuse
/// part. Black sides (the back of a one-sided wall, black lamps) only absorb; the rays that meet them say how
/// much.
bool can_hold_radiosity(const Scene& scene, std::uint32_t shape, Side side);

/// Divides the sides that can hold a radiosity into elements of one size, as fine as at most `max_elements`
/// allow; smaller triangles are joined to clusters of that size. There can be a few more elements than that
/// where not even the largest clusters are few enough. 0: one element a triangle side.
ElementMesh divide_surfaces(const Scene& scene, std::size_t max_elements);

}  // namespace twopass
