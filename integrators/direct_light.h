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

/// Who else finds the lights that next-event estimation samples.
enum class Rival : std::uint8_t {
  scattered_ray,  ///< the path goes on: both are weighted (I3)
  glossy_ray,     ///< the path goes on without what is reflected diffusely, of which the lights are sampled in
                  ///< full
  none            ///< the path ends here
};

/// The light sample weighted against its rival; its radiance is what the surface would reflect where `at` is
/// the model's value for it, of which the share `diffuse_share()` is reflected diffusely. With a `guide`, the
/// scattered ray is drawn from it with the probability `share` (I11). REQUIRES: incident.reached > 0.
template <class DiffuseShare>
Connection connection_to(const SurfacePoint& point, const Incident& incident, const BsdfValue& at, Rival rival,
                         const Guide::Lobe* guide, float share, const DiffuseShare& diffuse_share) {
  const LightSample& light = incident.light;
  const float in_full = 1.0f / light.pdf_w;
  C3f weight(in_full);
  if (!light.is_delta && rival != Rival::none) {
    float other = at.pdf_w;
    if (guide) other = share * guide->pdf_w(light.direction) + (1.0f - share) * other;
    // The power heuristic (I3) over the density, in one division: p_l / (p_l^2 + p_b^2).
    const float weighted =
        light.pdf_w < 1e18f ? light.pdf_w / (light.pdf_w * light.pdf_w + other * other) : 0.0f;
    weight = C3f(weighted);
    if (rival == Rival::glossy_ray) [[unlikely]]
      weight += diffuse_share() * (in_full - weighted);
  }
  return {{spawn_position(point, light.direction), light.position},
          at.value * weight * light.radiance * incident.reached,
          light.light};
}

}  // namespace twopass
