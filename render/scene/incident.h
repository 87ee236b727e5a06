// Light samples as they arrive at a surface.
#pragma once

#include "render/scene/scene.h"

namespace twopass {

/// Veach's power heuristic with exponent 2 (integrators, I3): the weight of a sample drawn with density `own`
/// that the other technique would draw with density `other`.
inline float power_heuristic(float own, float other) {
  const float ratio = other / own;
  return 1.0f / (1.0f + ratio * ratio);
}

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

}  // namespace twopass
