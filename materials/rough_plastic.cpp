#include "materials/rough_plastic.h"

#include "materials/fresnel.h"
#include "materials/lobe_choice.h"
#include "materials/plastic.h"
#include "render/core/warp.h"

namespace twopass {

// The base after bounces; radiance that leaves the coat is divided by eta^2 (M2).
C3f RoughPlastic::base() const {
  return base_after_bounces(base_reflectance, coat->internal_reflectance, nonlinear) * (1.0f / (eta * eta));
}

C3f RoughPlastic::eval(const V3f& wo, const V3f& wi) const {
  if (!(wi.z > 0.0f)) return C3f(0.0f);
  const V3f m = unit(wo + wi);
  float cos_t;
  const float reflected = fresnel_dielectric(std::min(wo.dot(m), 1.0f), eta, cos_t);
  const float through = coat->transmittance_at(wo.z) * coat->transmittance_at(wi.z);
  return specular_reflectance * (reflected * facets().reflection(wo, wi, m)) +
         base() * (through * cosine_hemisphere_pdf_w(wi.z));
}

float RoughPlastic::pdf_w(const V3f& wo, const V3f& wi) const {
  const float p = coat_probability(1.0f - coat->transmittance_at(wo.z), specular_reflectance, base_reflectance);
  if (!(wi.z > 0.0f && p >= 0.0f)) return 0.0f;
  return p * facets().reflection_pdf_w(wo, unit(wo + wi)) + (1.0f - p) * cosine_hemisphere_pdf_w(wi.z);
}

std::optional<BsdfSample> RoughPlastic::sample(const V3f& wo, const V2f& u) const {
  const float p = coat_probability(1.0f - coat->transmittance_at(wo.z), specular_reflectance, base_reflectance);
  if (!(p >= 0.0f)) return std::nullopt;
  V2f rest = u;
  const V3f wi = choose(rest.x, p) ? reflect(wo, facets().sample(wo, rest)) : square_to_cosine_hemisphere(rest);
  const float pdf = pdf_w(wo, wi);
  if (!(pdf > 0.0f)) return std::nullopt;
  return BsdfSample{wi, eval(wo, wi) * (1.0f / pdf), pdf, 1.0f, false};
}

}  // namespace twopass
