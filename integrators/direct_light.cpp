#include "integrators/direct_light.h"

namespace twopass {

std::optional<Connection> sample_direct_light(const Scene& scene, const SurfacePoint& point, const Bsdf& bsdf,
                                              const V3f& wo, Sampler& sampler) {
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
    const float other = pdf_w(bsdf, wo, wi);
    weight = light.pdf_w < 1e18f ? light.pdf_w / (light.pdf_w * light.pdf_w + other * other) : 0.0f;
  }
  return Connection{{spawn_position(point, light.direction), light.position},
                    scattered * light.radiance * weight};
}

}  // namespace twopass
