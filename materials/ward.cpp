#include "materials/ward.h"

#include "materials/lobe_choice.h"
#include "materials/microfacet.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

/// Probability of sampling the lobe. NaN for a black surface.
float lobe_probability(const Ward& ward) {
  const float lobe = mean_component(ward.specular_reflectance), base = mean_component(ward.base_reflectance);
  return lobe / (lobe + base);
}

/// The Gaussian in the slopes of the half vector h is Beckmann's density of facets.
MicrofacetDistribution gaussian(const Ward& ward) { return {Microfacet::beckmann, ward.alpha_u, ward.alpha_v}; }

/// The lobe for a specular reflectance of 1, times wi.z.
float lobe(const Ward& ward, const V3f& wo, const V3f& wi) {
  const V3f sum = wo + wi, h = unit(sum);
  const float density = gaussian(ward).density(h);
  if (ward.variant == WardVariant::balanced) return density / sum.dot(sum) * wi.z;
  const float z2 = h.z * h.z, unnormalised = 0.25f * density * z2 * z2;
  return ward.variant == WardVariant::ward ? unnormalised * std::sqrt(wi.z / wo.z) : unnormalised / wo.z;
}

V3f sample_half_vector(const Ward& ward, const V2f& u) {
  const V2f slope = circle(u.y) * std::sqrt(-std::log(1.0f - u.x));
  return unit(V3f(std::max(ward.alpha_u, 1e-4f) * slope.x, std::max(ward.alpha_v, 1e-4f) * slope.y, 1.0f));
}

}  // namespace

C3f Ward::eval(const V3f& wo, const V3f& wi) const {
  if (!(wi.z > 0.0f)) return C3f(0.0f);
  return specular_reflectance * lobe(*this, wo, wi) + base_reflectance * cosine_hemisphere_pdf_w(wi.z);
}

C3f Ward::eval_diffuse(const V3f&, const V3f& wi) const {
  return base_reflectance * cosine_hemisphere_pdf_w(wi.z);
}

float Ward::pdf_w(const V3f& wo, const V3f& wi) const {
  const float p = lobe_probability(*this);
  if (!(wi.z > 0.0f && p >= 0.0f)) return 0.0f;
  const V3f h = unit(wo + wi);
  const float half_vector_pdf = gaussian(*this).density(h) * h.z;
  return p * half_vector_pdf / (4.0f * wo.dot(h)) + (1.0f - p) * cosine_hemisphere_pdf_w(wi.z);
}

std::optional<BsdfSample> Ward::sample(const V3f& wo, const V2f& u) const {
  const float p = lobe_probability(*this);
  if (!(p >= 0.0f)) return std::nullopt;
  V2f rest = u;
  const V3f wi =
      choose(rest.x, p) ? reflect(wo, sample_half_vector(*this, rest)) : square_to_cosine_hemisphere(rest);
  const float pdf = pdf_w(wo, wi);
  if (!(pdf > 0.0f)) return std::nullopt;
  return BsdfSample{wi, eval(wo, wi) * (1.0f / pdf), pdf, 1.0f, false};
}

}  // namespace twopass
