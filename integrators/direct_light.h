// Direct light at a vertex by next-event estimation, weighed against scattered rays.
#pragma once

#include <optional>

#include "integrators/integrator.h"

namespace twopass {

/// Veach's power heuristic with exponent 2 (I3): the weight of a sample drawn with density `own` that the other
/// technique would draw with density `other`.
inline float power_heuristic(float own, float other) {
  const float ratio = other / own;
  return 1.0f / (1.0f + ratio * ratio);
}

/// A light sample that waits for its shadow ray.
struct Connection {
  Segment segment;  ///< from the surface to the light, clear of both
  C3f radiance;     ///< what the light adds if nothing is in between
};

/// One light sample at `point`, weighted against the scattered ray; its radiance is what the surface would
/// reflect towards wo (local, unit). Nothing where no light can come of it. REQUIRES: the scene has lights; the
/// surface is not purely specular.
inline std::optional<Connection> sample_direct_light(const Scene& scene, const SurfacePoint& point,
                                                     const Bsdf& bsdf, const V3f& wo, Sampler& sampler) {
  const LightSample light = scene.lights().sample(point.position, sampler.next_2d());
  if (!(light.pdf_w > 0.0f) || is_black(light.radiance)) return std::nullopt;
  const V3f wi = point.shading.to_local(light.direction);
  // Both normals must agree on the side, or light leaks through surfaces with interpolated normals.
  if (wi.z * light.direction.dot(point.geometric_normal) <= 0.0f) return std::nullopt;
  const C3f scattered = eval(bsdf, wo, wi);
  if (is_black(scattered)) return std::nullopt;
  // The power heuristic (I3) over the density, in one division: p_l / (p_l^2 + p_b^2).
  const float other = pdf_w(bsdf, wo, wi);
  const float weight = light.pdf_w < 1e18f ? light.pdf_w / (light.pdf_w * light.pdf_w + other * other) : 0.0f;
  return Connection{{spawn_position(point, light.direction), light.position},
                    scattered * light.radiance * weight};
}

}  // namespace twopass
