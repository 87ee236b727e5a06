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
  glossy_ray,     ///< the path goes on without what is reflected diffusely, of which the lights are sampled in full
  none            ///< the path ends here
};

/// The light sample of the number u at `point`, weighted against its rival; its radiance is what the
/// surface would reflect against `direction` (world, unit), which led to it. With a `guide`, the
/// scattered ray is drawn from it with the probability `share` (I11). REQUIRES: the scene has lights; the
/// surface is not purely specular.
inline Connection sample_direct_light(const Scene& scene, const SurfacePoint& point, const Bsdf& bsdf,
                                      const V3f& direction, Rival rival, const V2f& u,
                                      const Guide::Lobe* guide = nullptr, float share = 0.0f) {
  const Connection nothing{{V3f(0.0f), V3f(0.0f)}, C3f(0.0f), 0};
  const LightSample light = scene.lights().sample(receiver_at(point, bsdf), u);
  if (!(light.pdf_w > 0.0f)) return nothing;
  const V3f wi = point.shading.to_local(light.direction);
  const float reached = agreement_of_normals(point, light.direction, wi.z);
  if (reached == 0.0f) return nothing;
  const C3f radiance = visit_model(bsdf, [&](const auto& model) {
    // Inside, because Lambert's model does not look at it.
    const V3f wo = point.shading.to_local(-direction);
    if (light.is_delta || rival == Rival::none)
      return C3f(model.eval(wo, wi) * light.radiance * (reached / light.pdf_w));
    const BsdfValue at = evaluate(model, wo, wi);
    float other = at.pdf_w;
    if (guide) other = share * guide->pdf_w(light.direction) + (1.0f - share) * other;
    // The power heuristic (I3) over the density, in one division: p_l / (p_l^2 + p_b^2).
    const float weight = light.pdf_w < 1e18f ? light.pdf_w / (light.pdf_w * light.pdf_w + other * other) : 0.0f;
    C3f weighted = at.value * weight;
    if (rival == Rival::glossy_ray) [[unlikely]]
      weighted += at.value * diffuse_share(bsdf, wo, wi) * (1.0f / light.pdf_w - weight);
    return C3f(weighted * light.radiance * reached);
  });
  return {{spawn_position(point, light.direction), light.position}, radiance, light.light};
}

}  // namespace twopass
