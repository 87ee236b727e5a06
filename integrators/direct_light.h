// Direct light at a vertex by next-event estimation, weighed against scattered rays.
#pragma once

#include "integrators/integrator.h"
#include "radiosity/guide.h"
#include "render/scene/incident.h"

namespace twopass {

/// A light sample that waits for its shadow ray.
struct Connection {
  Segment segment;      ///< from the surface to the light, clear of both
  C3f radiance;         ///< what the light adds if nothing is in between; black: no ray is needed
  std::uint32_t light;  ///< its number
};

/// What a surface sends on of a light sample if that is not weighted: of light that nothing else finds.
/// `value`: the model's for it.
inline C3f in_full(const Incident& incident, const C3f& value) {
  return value * incident.light.radiance * (incident.reached / incident.light.pdf_w);
}

/// The light sample as the surface would reflect it where `at` is the model's value for it: in full if the path
/// ends there, else weighted against the scattered ray, which is drawn from a `guide`, if there is one, with
/// the probability `share` (I11). REQUIRES: incident.reached > 0.
inline Connection connection_to(const SurfacePoint& point, const Incident& incident, const BsdfValue& at,
                                bool goes_on, const Guide::Lobe* guide, float share) {
  const LightSample& light = incident.light;
  float weight = 1.0f / light.pdf_w;
  if (!light.is_delta && goes_on) {
    float other = at.pdf_w;
    if (guide) other = share * guide->pdf_w(light.direction) + (1.0f - share) * other;
    // The power heuristic (I3) over the density, in one division: p_l / (p_l^2 + p_b^2).
    weight = light.pdf_w < 1e18f ? light.pdf_w / (light.pdf_w * light.pdf_w + other * other) : 0.0f;
  }
  return {{spawn_position(point, light.direction), light.position},
          at.value * weight * light.radiance * incident.reached,
          light.light};
}

}  // namespace twopass
