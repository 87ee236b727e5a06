// Which of the surfaces that meet at a point or an edge are one smooth surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/core/types.h"

namespace twopass {

/// Labels 0, 1, ... for unit normals: those that are joined by steps of less than 30 degrees share one. A zero
/// normal, of a triangle without area, is alone. Where more than 32 normals meet, at the tip of a fan, the
/// steps are known to 12 degrees only; equal normals always share their label. Work grows with the number of
/// normals.
void smooth_groups(std::span<const V3f> normals, std::vector<std::uint32_t>& label);

}  // namespace twopass
