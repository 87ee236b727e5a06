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

/// The scattering model's own.
class ScatteredDirections {
 public:
  /// `wo`: local, unit. REQUIRES: the model outlives this.
  ScatteredDirections(const Bsdf& bsdf, const V3f& wo) : bsdf_(bsdf), wo_(wo) {}
  [[nodiscard]] std::optional<BsdfSample> sample(const V2f& u) const { return twopass::sample(bsdf_, wo_, u); }
  /// Of a direction, in the world and local.
  [[nodiscard]] float pdf_w(const V3f&, const V3f& wi) const { return twopass::pdf_w(bsdf_, wo_, wi); }

 private:
  const Bsdf& bsdf_;
  V3f wo_;
};

/// A light sample that waits for its shadow ray.
struct Connection {
  Segment segment;  ///< from the surface to the light, clear of both
  C3f radiance;     ///< what the light adds if nothing is in between
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

/// One light sample at `point`, weighted against the scattered ray; its radiance is what the surface would
/// reflect towards wo (local, unit). `directions`: what the scattered ray is drawn from. Nothing where no light
/// can come of it. REQUIRES: the scene has lights; the surface is not purely specular.
template <class Directions>
std::optional<Connection> sample_direct_light(const Scene& scene, const SurfacePoint& point, const Bsdf& bsdf,
                                              const V3f& wo, const Directions& directions, Sampler& sampler) {
  const LightSample light = scene.lights().sample(receiver_at(point, bsdf), sampler.next_2d());
  if (!(light.pdf_w > 0.0f) || is_black(light.radiance)) return std::nullopt;
  const V3f wi = point.shading.to_local(light.direction);
  const float reached = agreement_of_normals(point, light.direction, wi.z);
  if (reached == 0.0f) return std::nullopt;
  const C3f scattered = eval(bsdf, wo, wi) * reached;
  if (is_black(scattered)) return std::nullopt;
  float weight = 1.0f / light.pdf_w;
  if (!light.is_delta) {
    // The power heuristic (I3) over the density, in one division: p_l / (p_l^2 + p_b^2).
    const float other = directions.pdf_w(light.direction, wi);
    weight = light.pdf_w < 1e18f ? light.pdf_w / (light.pdf_w * light.pdf_w + other * other) : 0.0f;
  }
  return Connection{{spawn_position(point, light.direction), light.position},
                    scattered * light.radiance * weight};
}

}  // namespace twopass
