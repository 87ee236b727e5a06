// Clamping: an optional limit to what one path may add to a sample. Biased, against rare bright samples.
#pragma once

#include "integrators/integrator.h"

namespace twopass {

inline bool is_clamped(const PathLimits& limits) {
  return std::isfinite(limits.clamp_direct) || std::isfinite(limits.clamp_indirect);
}

/// What a path of `edges` edges may add where it carries `radiance`: scaled so that its largest channel is at
/// most the limit for direct (two edges) or indirect light (more); the colour stays. Light seen directly (one
/// edge) is never clamped.
inline C3f clamped(const C3f& radiance, int edges, const PathLimits& limits) {
  const float most = edges <= 1 ? infinity_f : edges == 2 ? limits.clamp_direct : limits.clamp_indirect;
  const float largest = max_component(radiance);
  return largest > most ? radiance * (most / largest) : radiance;
}

}  // namespace twopass
