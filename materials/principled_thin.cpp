#include "materials/principled_thin.h"

#include "materials/principled_lobes.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

V3f mirrored(const V3f& w) { return {w.x, w.y, -w.z}; }

/// Facets of the light that passes: two interfaces blur more the stronger they refract (Burley 2015, figure
/// 15).
GgxFacets facets_passed(float roughness, float anisotropic, float eta) {
  return GgxFacets::from_roughness((0.65f * eta - 0.35f) * roughness, anisotropic);
}

}  // namespace

/// Probabilities of the lobes up to a common factor.
struct PrincipledThin::LobeWeights {
  float mirror, passed, diffuse, diffuse_passed;
  [[nodiscard]] float sum() const { return mirror + passed + diffuse + diffuse_passed; }
};

PrincipledThin::LobeWeights PrincipledThin::lobe_weights() const {
  const float clear = std::clamp(spec_trans, 0.0f, 1.0f);
  const float passing = std::clamp(0.5f * diff_trans, 0.0f, 1.0f);
  return {0.5f * clear * specular_reflectance_sampling_rate,
          0.5f * clear * specular_transmittance_sampling_rate,
          (1.0f - clear) * (1.0f - passing) * diffuse_reflectance_sampling_rate,
          (1.0f - clear) * passing * diffuse_transmittance_sampling_rate};
}

C3f PrincipledThin::reflected_by_facets(const V3f& wo, const V3f& wi, const V3f& h) const {
  if (!(spec_trans > 0.0f)) return C3f(0.0f);
  const float cos_d = wo.dot(h);
  C3f fresnel(facet_fresnel(cos_d, eta) * (1.0f - spec_tint));
  if (spec_tint > 0.0f) {
    const float normal_incidence = (eta - 1.0f) * (eta - 1.0f) / ((eta + 1.0f) * (eta + 1.0f));
    fresnel += schlick(tint(base_color, 1.0f) * normal_incidence, cos_d, eta) * spec_tint;
  }
  const GgxFacets facets = GgxFacets::from_roughness(roughness, anisotropic);
  return fresnel *
         (spec_trans * facets.distribution(h) * facets.visible(wi, h) * facets.visible(wo, h) / (4.0f * wo.z));
}

C3f PrincipledThin::reflected_diffusely(const V3f& wo, const V3f& wi, const V3f& h) const {
  const float diffuse = (1.0f - spec_trans) * (1.0f - 0.5f * diff_trans);
  if (!(diffuse > 0.0f) || !has_diffuse) return C3f(0.0f);
  const float cos_d = wo.dot(h);
  C3f sum = base_color * (burley_diffuse(wo.z, wi.z, cos_d, roughness, flatness) / pi_f);
  if (sheen > 0.0f) sum += tint(base_color, sheen_tint) * (sheen * schlick_weight(cos_d));
  return sum * (diffuse * wi.z);
}

C3f PrincipledThin::transmitted(const V3f& wo, const V3f& wi) const {
  float value = std::max(0.0f, (1.0f - spec_trans) * 0.5f * diff_trans) * (-wi.z / pi_f);
  if (spec_trans > 0.0f) {
    // Reflected first, then turned to the other side: a sheet does not bend light.
    const V3f h = unit(wo + mirrored(wi));
    const GgxFacets facets = facets_passed(roughness, anisotropic, eta);
    value += spec_trans * (1.0f - facet_fresnel(wo.dot(h), eta)) * facets.distribution(h) *
             facets.visible(wi, h) * facets.visible(wo, h) / (4.0f * wo.z);
  }
  return base_color * value;
}

C3f PrincipledThin::eval(const V3f& wo, const V3f& wi) const {
  if (wi.z == 0.0f) return C3f(0.0f);
  if (wi.z < 0.0f) return transmitted(wo, wi);
  const V3f h = unit(wo + wi);
  return reflected_by_facets(wo, wi, h) + reflected_diffusely(wo, wi, h);
}

C3f PrincipledThin::eval_diffuse(const V3f& wo, const V3f& wi) const {
  return reflected_diffusely(wo, wi, unit(wo + wi));
}

float PrincipledThin::pdf_w(const V3f& wo, const V3f& wi) const {
  const LobeWeights weights = lobe_weights();
  const float sum = weights.sum();
  if (!(sum > 0.0f) || wi.z == 0.0f) return 0.0f;
  const bool reflects = wi.z > 0.0f;
  float pdf = (reflects ? weights.diffuse : weights.diffuse_passed) * cosine_hemisphere_pdf_w(std::abs(wi.z));
  const float facet_weight = reflects ? weights.mirror : weights.passed;
  if (facet_weight > 0.0f) {
    const V3f h = unit(wo + (reflects ? wi : mirrored(wi)));
    const GgxFacets facets = reflects ? GgxFacets::from_roughness(roughness, anisotropic)
                                      : facets_passed(roughness, anisotropic, eta);
    // Facets that show the light their face cannot pass it to the other side.
    if (reflects || wi.dot(h) < 0.0f)
      pdf += facet_weight * facets.distribution(h) * facets.visible(wo, h) / (4.0f * wo.z);
  }
  return pdf / sum;
}

std::optional<BsdfSample> PrincipledThin::sample(const V3f& wo, const V2f& u) const {
  const LobeWeights weights = lobe_weights();
  const float sum = weights.sum();
  if (!(sum > 0.0f)) return std::nullopt;
  LobeChoice choice(u.x, sum);
  const auto off_facet = [&](const GgxFacets& facets, V3f& h) {
    h = facets.sample(wo, V2f(choice.u(), u.y));
    return unit(h * (2.0f * wo.dot(h)) - wo);
  };
  V3f h(0.0f);
  V3f wi;
  bool through = false;
  if (choice.is(weights.mirror)) {
    wi = off_facet(GgxFacets::from_roughness(roughness, anisotropic), h);
  } else if (choice.is(weights.passed)) {
    wi = mirrored(off_facet(facets_passed(roughness, anisotropic, eta), h));
    if (wi.dot(h) >= 0.0f) return std::nullopt;  // as in pdf_w()
    through = true;
  } else if (choice.is(weights.diffuse)) {
    wi = square_to_cosine_hemisphere(V2f(choice.u(), u.y));
  } else {
    if (weights.diffuse_passed == 0.0f) return std::nullopt;  // rounding past the last lobe
    choice.take_last(weights.diffuse_passed);
    wi = mirrored(square_to_cosine_hemisphere(V2f(choice.u(), u.y)));
    through = true;
  }
  if (through ? wi.z >= 0.0f : wi.z <= 0.0f) return std::nullopt;
  const float pdf = pdf_w(wo, wi);
  const C3f value = eval(wo, wi);
  if (!(pdf > 0.0f) || is_black(value)) return std::nullopt;
  return BsdfSample{wi, value * (1.0f / pdf), pdf, 1.0f, false};
}

PrincipledThin PrincipledThin::without_diffuse() const {
  PrincipledThin rest = *this;
  rest.has_diffuse = false;
  rest.diffuse_reflectance_sampling_rate = 0.0f;
  return rest;
}

C3f PrincipledThin::diffuse_reflectance() const {
  if (!has_diffuse) return C3f(0.0f);
  const float diffuse = std::max(0.0f, (1.0f - spec_trans) * (1.0f - 0.5f * diff_trans));
  const C3f albedo = (base_color * burley_diffuse_albedo(roughness, flatness) +
                      tint(base_color, sheen_tint) * (sheen * sheen_albedo)) *
                     diffuse;
  return {std::min(albedo.x, 1.0f), std::min(albedo.y, 1.0f), std::min(albedo.z, 1.0f)};
}

}  // namespace twopass
