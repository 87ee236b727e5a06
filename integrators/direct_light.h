// Direct light at a vertex by next-event estimation, weighed against scattered rays.
#pragma once

#include "integrators/integrator.h"
#include "materials/lobes.h"
#include "radiosity/guide.h"

namespace twopass {

/// Veach's power heuristic with exponent 2 (I3): the weight of a sample drawn with density `own` that the other
/// technique would draw with density `other`.
inline float power_heuristic(float own, float other) {
  const float ratio = other / own;
  return 1.0f / (1.0f + ratio * ratio);
}

/// A light sample that waits for its shadow ray.
struct Connection {
  Segment segment;      ///< from the surface to the light, clear of both
  C3f radiance;         ///< what the light adds if nothing is in between; black: no ray is needed
  std::uint32_t light;  ///< its number
};

/// A vertex as the lights see it.
inline Receiver receiver_at(const SurfacePoint& point, const Bsdf& bsdf) {
  return {point.position, point.shading.n, std::holds_alternative<Diffuse>(bsdf)};
}

/// How much of the light from `direction` (unit; `cosine` with the shading normal) the normals of the point let
/// through: nothing where they disagree on the side that it comes from, or light would leak through surfaces
/// with interpolated normals; less than 1 at grazing angles on bumps (materials, M30).
inline float agreement_of_normals(const SurfacePoint& point, const V3f& direction, float cosine) {
  if (cosine * direction.dot(point.geometric_normal) <= 0.0f) return 0.0f;
  if (point.terminator == 0.0f) return 1.0f;
  const float unperturbed = direction.dot(point.unperturbed_normal);
  return cosine * unperturbed > 0.0f ? soft_terminator(point.terminator, unperturbed) : 0.0f;
}

/// Who else finds the lights that next-event estimation samples.
enum class Rival : std::uint8_t {
  scattered_ray,  ///< the path goes on: both are weighted (I3)
  glossy_ray,     ///< the path goes on without what is reflected diffusely, of which the lights are sampled in
                  ///< full
  none            ///< the path ends here
};

/// A light sample as it arrives at a surface.
struct Incident {
  LightSample light;
  V3f wi;         ///< its direction in the shading frame
  float reached;  ///< see agreement_of_normals(); 0: nothing arrives
};

/// The light sample of the number u at `point`. REQUIRES: the scene has lights; the surface is not purely
/// specular.
inline Incident sample_incident(const Scene& scene, const SurfacePoint& point, const Bsdf& bsdf, const V2f& u) {
  Incident incident{scene.lights().sample(receiver_at(point, bsdf), u), V3f(0.0f), 0.0f};
  const LightSample& light = incident.light;
  if (!(light.pdf_w > 0.0f)) return incident;
  incident.wi = point.shading.to_local(light.direction);
  incident.reached = agreement_of_normals(point, light.direction, incident.wi.z);
  return incident;
}

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
