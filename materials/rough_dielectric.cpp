#include "materials/rough_dielectric.h"

#include "materials/fresnel.h"

namespace twopass {

namespace {

/// The facet normal that leads `wi` to `wo`; zero when there is none (both are then on its same side).
V3f facet_between(const V3f& wo, const V3f& wi, float eta) {
  if (wi.z > 0.0f) return unit(wo + wi);
  V3f m = unit(wo + wi * eta);
  if (m.z < 0.0f) m = -m;
  return wo.dot(m) > 0.0f && wi.dot(m) < 0.0f ? m : V3f(0.0f);
}

/// |d m / d wi| for refraction (Walter et al. 2007, eq. 17).
float refraction_jacobian(float wo_m, float wi_m, float eta) {
  const float path = wo_m + eta * wi_m;
  return eta * eta * std::abs(wi_m) / (path * path);
}

/// A third random number, from the digits of both numbers below 2^-12. Whether a facet reflects or refracts can
/// be chosen only once it is known, and it takes both numbers; their last digits hardly matter to it.
float spare_number(const V2f& u) {
  const float x = u.x * 4096.0f, y = u.y * 4096.0f;
  return (std::floor((x - std::floor(x)) * 4096.0f) + (y - std::floor(y))) * (1.0f / 4096.0f);
}

}  // namespace

C3f RoughDielectric::eval(const V3f& wo, const V3f& wi) const {
  const V3f m = facet_between(wo, wi, eta);
  const float wo_m = std::min(wo.dot(m), 1.0f), wi_m = wi.dot(m);
  if (!(wo_m > 0.0f) || wi.z == 0.0f) return C3f(0.0f);
  const MicrofacetDistribution surface = facets();
  float cos_t;
  const float reflected = fresnel_dielectric(wo_m, eta, cos_t);
  if (wi.z > 0.0f) return specular_reflectance * (reflected * surface.reflection(wo, wi, m));
  // eta^2 of the Jacobian cancels the compression of radiance (M2).
  const float facet = surface.density(m) * surface.masking(wo, m) * surface.masking(wi, m) * wo_m / wo.z;
  return specular_transmittance *
         ((1.0f - reflected) * facet * refraction_jacobian(wo_m, wi_m, eta) / (eta * eta));
}

float RoughDielectric::pdf_w(const V3f& wo, const V3f& wi) const {
  const V3f m = facet_between(wo, wi, eta);
  const float wo_m = std::min(wo.dot(m), 1.0f);
  if (!(wo_m > 0.0f) || wi.z == 0.0f) return 0.0f;
  float cos_t;
  const float reflected = fresnel_dielectric(wo_m, eta, cos_t);
  if (wi.z > 0.0f) return reflected * facets().reflection_pdf_w(wo, m);
  return (1.0f - reflected) * facets().pdf_w(wo, m) * refraction_jacobian(wo_m, wi.dot(m), eta);
}

std::optional<BsdfSample> RoughDielectric::sample(const V3f& wo, const V2f& u) const {
  const MicrofacetDistribution surface = facets();
  const V3f m = surface.sample(wo, u);
  const float wo_m = std::min(wo.dot(m), 1.0f);
  if (!(wo_m > 0.0f)) return std::nullopt;
  float cos_t;
  const float reflected = fresnel_dielectric(wo_m, eta, cos_t);
  if (spare_number(u) < reflected) {
    const V3f wi = reflect(wo, m);
    const float pdf = reflected * surface.reflection_pdf_w(wo, m);
    if (!(wi.z > 0.0f && pdf > 0.0f)) return std::nullopt;
    return BsdfSample{wi, specular_reflectance * surface.sample_weight(wo, wi, m), pdf, 1.0f, false};
  }
  const float scale = 1.0f / eta;
  const V3f wi = unit(m * (wo_m * scale - cos_t) - wo * scale);
  const float pdf = (1.0f - reflected) * surface.pdf_w(wo, m) * refraction_jacobian(wo_m, -cos_t, eta);
  if (!(wi.z < 0.0f && pdf > 0.0f)) return std::nullopt;
  return BsdfSample{wi, specular_transmittance * (surface.sample_weight(wo, wi, m) * scale * scale), pdf, eta,
                    false};
}

}  // namespace twopass
