// Keeping heuristic models from reflecting more than they receive.
#pragma once

#include "render/core/types.h"

namespace twopass {

/// What a loader multiplies both reflectances of a Phong or Ward model with: 1 when their greatest values, over
/// textures and channels, sum to at most 1, otherwise 0.99 over that sum (a rule of Mitsuba 0.6; worth a note
/// to the user).
inline float energy_conserving_scale(const C3f& specular_max, const C3f& diffuse_max) {
  const float sum = max_component(specular_max + diffuse_max);
  return sum > 1.0f ? 0.99f / sum : 1.0f;
}

}  // namespace twopass
