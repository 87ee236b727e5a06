#include "materials/rough_plastic.h"

#include "materials/fresnel.h"
#include "materials/lobe_choice.h"
#include "materials/plastic.h"
#include "render/core/warp.h"

namespace twopass {

// The base after bounces; radiance that leaves the coat is divided by eta^2 (M2).
C3f RoughPlastic::base() const {
  return base_after_bounces(base_reflectance, coat->escape, nonlinear) * (1.0f / (eta * eta));
}

float RoughPlastic::coat_probability_at(float cosine) const {
  return coat_probability(1.0f - coat->transmittance_at(cosine), specular_reflectance, base_reflectance);
}

BsdfValue RoughPlastic::evaluate(const V3f& wo, const V3f& wi) const {
  return evaluate(wo, wi, coat_probability_at(wo.z));
}

BsdfValue RoughPlastic::evaluate(const V3f& wo, const V3f& wi, float p) const {
  if (!(wi.z > 0.0f)) return {C3f(0.0f), 0.0f};
  const V3f m = unit(wo + wi);
  float cos_t;
  const float reflected = fresnel_dielectric(std::min(wo.dot(m), 1.0f), eta, cos_t);
  const MicrofacetDistribution::Reflection facet = facets().reflection_and_pdf_w(wo, wi, m);
  return {specular_reflectance * (reflected * facet.value) + eval_diffuse(wo, wi),
          p >= 0.0f ? p * facet.pdf_w + (1.0f - p) * cosine_hemisphere_pdf_w(wi.z) : 0.0f};
}

C3f RoughPlastic::eval_diffuse(const V3f& wo, const V3f& wi) const {
  const float through = coat->transmittance_at(wo.z) * coat->transmittance_at(wi.z);
  return base() * (through * cosine_hemisphere_pdf_w(wi.z));
}

std::optional<BsdfSample> RoughPlastic::sample(const V3f& wo, const V2f& u) const {
  const float p = coat_probability_at(wo.z);
  if (!(p >= 0.0f)) return std::nullopt;
  V2f rest = u;
  const V3f wi = choose(rest.x, p) ? reflect(wo, facets().sample(wo, rest)) : square_to_cosine_hemisphere(rest);
  const BsdfValue at = evaluate(wo, wi, p);
  if (!(at.pdf_w > 0.0f)) return std::nullopt;
  return BsdfSample{wi, at.value * (1.0f / at.pdf_w), at.pdf_w, 1.0f, false};
}

}  // namespace twopass
