#include "integrators/direct_light.h"

namespace twopass {

C3f sample_direct_light(const Scene& scene, const SurfacePoint& point, const Bsdf& bsdf, const V3f& wo,
                        Sampler& sampler, RayCounts& counts) {
  const LightSample light = scene.lights().sample(receiver_at(point, bsdf), sampler.next_2d());
  if (!(light.pdf_w > 0.0f) || is_black(light.radiance)) return C3f(0.0f);
  const V3f wi = point.shading.to_local(light.direction);
  // Both normals must agree on the side, or light leaks through surfaces with interpolated normals.
  if (wi.z * light.direction.dot(point.geometric_normal) <= 0.0f) return C3f(0.0f);
  const C3f scattered = eval(bsdf, wo, wi);
  if (is_black(scattered)) return C3f(0.0f);
  ++counts.shadow_rays;
  if (scene.caster().occluded(spawn_position(point, light.direction), light.position)) return C3f(0.0f);
  if (light.is_delta) return scattered * light.radiance * (1.0f / light.pdf_w);
  // The power heuristic (I3) over the density, in one division: p_l / (p_l^2 + p_b^2).
  const float other = pdf_w(bsdf, wo, wi);
  const float weight = light.pdf_w < 1e18f ? light.pdf_w / (light.pdf_w * light.pdf_w + other * other) : 0.0f;
  return scattered * light.radiance * weight;
}

}  // namespace twopass
