// Direct light at a vertex by next-event estimation, weighed against scattered rays.
#pragma once

#include "integrators/integrator.h"

namespace twopass {

/// Veach's power heuristic with exponent 2 (I3): the weight of a sample drawn with density `own` that the other
/// technique would draw with density `other`.
inline float power_heuristic(float own, float other) {
  const float ratio = other / own;
  return 1.0f / (1.0f + ratio * ratio);
}

/// A vertex as the lights see it.
inline Receiver receiver_at(const SurfacePoint& point, const Bsdf& bsdf) {
  return {point.position, point.shading.n, std::holds_alternative<Diffuse>(bsdf)};
}

/// One light sample at `point`, weighted against the scattered ray: radiance reflected towards wo (local,
/// unit). REQUIRES: the surface is not purely specular.
C3f sample_direct_light(const Scene& scene, const SurfacePoint& point, const Bsdf& bsdf, const V3f& wo,
                        Sampler& sampler, RayCounts& counts);

}  // namespace twopass
