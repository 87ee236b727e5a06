// Lamps that stand in a file twice, in the same place.
#pragma once

#include "render/scene/scene.h"

namespace twopass {

/// Leaves out triangles of lamps that have the three corners of an earlier triangle of a lamp, if they emit on
/// no side on which that does not: a ray meets one of the two, sampling lights finds both, so that their light
/// would count up to twice. Returns how many were left out. Shapes stay, if without triangles.
std::size_t leave_out_duplicate_lamps(SceneDescription& scene);

}  // namespace twopass
