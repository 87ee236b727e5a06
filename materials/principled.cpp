#include "materials/principled.h"

#include "materials/fresnel.h"
#include "materials/principled_lobes.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

constexpr float clearcoat_strength = 0.25f;     // Burley 2012, section 5.6
constexpr float clearcoat_mask_width = 0.25f;   // GGX width of the coat's shadowing, there as well
constexpr float clearcoat_reflectance = 0.04f;  // of an index of refraction of 1.5

/// The facet normal that refracts `wo` into `wi`, on the viewer's side; zero if none does.
V3f refracting_normal(const V3f& wo, const V3f& wi, float eta) {
  const V3f h = unit(wo + wi * eta);
  return h.z < 0.0f ? -h : h;
}

/// Whether the facets face the viewer and turn their back to the light, as refraction needs.
bool refracts(const V3f& wo, const V3f& wi, const V3f& h) { return wo.dot(h) > 0.0f && wi.dot(h) < 0.0f; }

}  // namespace

float eta_of_specular(float specular) { return 2.0f / (1.0f - std::sqrt(0.08f * specular)) - 1.0f; }

Principled Principled::from_behind() const {
  Principled result = *this;
  result.eta = 1.0f / eta;
  result.inside = !inside;
  return result;
}

float Principled::opaque_weight() const {
  return inside ? 0.0f : std::max(0.0f, (1.0f - metallic) * (1.0f - spec_trans));
}
float Principled::glass_weight() const { return std::max(0.0f, (1.0f - metallic) * spec_trans); }

/// Probabilities of the lobes up to a common factor (M24).
struct Principled::LobeWeights {
  float diffuse, clearcoat, reflection, refraction;
  [[nodiscard]] float sum() const { return diffuse + clearcoat + reflection + refraction; }
};

Principled::LobeWeights Principled::lobe_weights(float cos_o) const {
  const float glass = glass_weight();
  if (inside && glass == 0.0f) return {0.0f, 0.0f, 0.0f, 0.0f};
  LobeWeights weights{opaque_weight() * diffuse_reflectance_sampling_rate, 0.0f, main_specular_sampling_rate,
                      0.0f};
  if (inside)
    weights.reflection = 1.0f;
  else
    weights.clearcoat = clearcoat_strength * clearcoat * clearcoat_sampling_rate;
  if (glass > 0.0f) {
    // Mitsuba decides by the Fresnel reflectance of the facet that was drawn, with a third random number. Two
    // are enough when the surface decides: with more doubt the rougher it is, so that no weight explodes.
    const GgxFacets facets = GgxFacets::from_roughness(roughness, anisotropic);
    const float doubt = std::min(1.0f, std::max(facets.ax, facets.ay));
    const float reflected = facet_fresnel(cos_o, eta) * (1.0f - doubt) + 0.5f * doubt;
    weights.refraction = weights.reflection * (inside ? 1.0f : glass) * (1.0f - reflected);
    weights.reflection -= weights.refraction;
  }
  return weights;
}

C3f Principled::reflected_by_facets(const V3f& wo, const V3f& wi, const V3f& h) const {
  const float cos_h = wo.dot(h);
  const float dielectric = facet_fresnel(cos_h, eta);
  C3f value(0.0f);
  // As in Mitsuba, a surface without any index step has no facets, not even of metal.
  if (dielectric > 0.0f) {
    C3f fresnel(glass_weight() * dielectric);
    if (!inside) {
      const float normal_incidence = (eta - 1.0f) * (eta - 1.0f) / ((eta + 1.0f) * (eta + 1.0f));
      fresnel = C3f((1.0f - metallic) * (1.0f - spec_tint) * dielectric);
      if (metallic > 0.0f) fresnel += schlick(base_color, cos_h, eta) * metallic;
      if (spec_tint > 0.0f)
        fresnel +=
            schlick(tint(base_color, 1.0f) * normal_incidence, cos_h, eta) * ((1.0f - metallic) * spec_tint);
    }
    const GgxFacets facets = GgxFacets::from_roughness(roughness, anisotropic);
    value = fresnel * (facets.distribution(h) * facets.visible(wi, h) * facets.visible(wo, h) / (4.0f * wo.z));
  }
  if (!inside && clearcoat > 0.0f) {
    const GgxFacets mask{clearcoat_mask_width, clearcoat_mask_width};
    value += schlick(C3f(clearcoat_reflectance), cos_h, eta) *
             (clearcoat_strength * clearcoat * Gtr1Facets::from_gloss(clearcoat_gloss).distribution(h) *
              mask.visible(wo, h) * mask.visible(wi, h) * wi.z);
  }
  return value;
}

C3f Principled::reflected_diffusely(const V3f& wo, const V3f& wi, const V3f& h) const {
  const float opaque = opaque_weight();
  if (opaque == 0.0f || !has_diffuse) return C3f(0.0f);
  const float cos_d = wi.dot(h);
  C3f value = base_color * (opaque / pi_f * burley_diffuse(wo.z, wi.z, cos_d, roughness, flatness));
  if (sheen > 0.0f) value += tint(base_color, sheen_tint) * (sheen * (1.0f - metallic) * schlick_weight(cos_d));
  return value * wi.z;
}

C3f Principled::refracted(const V3f& wo, const V3f& wi) const {
  const float glass = glass_weight();
  if (glass == 0.0f) return C3f(0.0f);
  const V3f h = refracting_normal(wo, wi, eta);
  if (!refracts(wo, wi, h)) return C3f(0.0f);
  const GgxFacets facets = GgxFacets::from_roughness(roughness, anisotropic);
  const float cos_o = wo.dot(h), cos_i = wi.dot(h);
  const float spread = cos_o + eta * cos_i;
  // Walter et al. 2007, equation (21), for radiance: the eta^2 of the Jacobian is what compression takes.
  const float value = glass * (1.0f - facet_fresnel(cos_o, eta)) * facets.distribution(h) *
                      facets.visible(wo, h) * facets.visible(wi, h) * std::abs(cos_o * cos_i) /
                      (wo.z * spread * spread);
  // The surface is crossed twice, in and out: each time its colour counts half.
  const auto root = [](float x) { return std::sqrt(std::max(0.0f, x)); };
  return C3f(root(base_color.x), root(base_color.y), root(base_color.z)) * value;
}

C3f Principled::eval(const V3f& wo, const V3f& wi) const {
  if (wi.z < 0.0f) return refracted(wo, wi);
  if (wi.z == 0.0f || (inside && glass_weight() == 0.0f)) return C3f(0.0f);
  const V3f h = unit(wo + wi);
  return reflected_by_facets(wo, wi, h) + reflected_diffusely(wo, wi, h);
}

C3f Principled::eval_diffuse(const V3f& wo, const V3f& wi) const {
  return reflected_diffusely(wo, wi, unit(wo + wi));
}

float Principled::pdf_w(const V3f& wo, const V3f& wi) const {
  const LobeWeights weights = lobe_weights(wo.z);
  const float sum = weights.sum();
  if (sum == 0.0f || wi.z == 0.0f) return 0.0f;
  const GgxFacets facets = GgxFacets::from_roughness(roughness, anisotropic);
  if (wi.z > 0.0f) {
    const V3f both = wo + wi, h = unit(both);
    float pdf = weights.diffuse * cosine_hemisphere_pdf_w(wi.z) +
                weights.reflection * facets.distribution(h) * facets.visible(wo, h) / (4.0f * wo.z);
    // The half vector's cosine is half the length of the sum, which keeps its digits where both directions
    // graze.
    if (weights.clearcoat > 0.0f)
      pdf += weights.clearcoat * Gtr1Facets::from_gloss(clearcoat_gloss).distribution(h) * h.z /
             (2.0f * both.length());
    return pdf / sum;
  }
  if (weights.refraction == 0.0f) return 0.0f;
  const V3f h = refracting_normal(wo, wi, eta);
  if (!refracts(wo, wi, h)) return 0.0f;
  const float cos_o = wo.dot(h), cos_i = wi.dot(h);
  const float spread = cos_o + eta * cos_i;
  const float jacobian = eta * eta * std::abs(cos_i) / (spread * spread);
  return weights.refraction / sum * facets.distribution(h) * facets.visible(wo, h) * cos_o / wo.z * jacobian;
}

std::optional<BsdfSample> Principled::sample(const V3f& wo, const V2f& u) const {
  const LobeWeights weights = lobe_weights(wo.z);
  const float sum = weights.sum();
  if (!(sum > 0.0f)) return std::nullopt;
  LobeChoice choice(u.x, sum);
  V3f wi;
  bool through = false;
  if (choice.is(weights.diffuse)) {
    wi = square_to_cosine_hemisphere(V2f(choice.u(), u.y));
  } else if (choice.is(weights.clearcoat)) {
    const V3f h = Gtr1Facets::from_gloss(clearcoat_gloss).sample(V2f(choice.u(), u.y));
    wi = h * (2.0f * wo.dot(h)) - wo;
  } else {
    through = choice.is(weights.refraction);
    if (!through) choice.take_last(weights.reflection);
    const GgxFacets facets = GgxFacets::from_roughness(roughness, anisotropic);
    const V3f h = facets.sample(wo, V2f(choice.u(), u.y));
    const float cos_h = wo.dot(h);
    if (through) {
      float cos_t;
      if (fresnel_dielectric(std::clamp(cos_h, 0.0f, 1.0f), eta, cos_t) == 1.0f) return std::nullopt;
      wi = wo * (-1.0f / eta) + h * (cos_h / eta - cos_t);
    } else {
      wi = h * (2.0f * cos_h) - wo;
    }
  }
  // Facets may send light to the wrong side of the surface, where nothing answers.
  if (through ? wi.z >= 0.0f : wi.z <= 0.0f) return std::nullopt;
  wi = unit(wi);
  const float pdf = pdf_w(wo, wi);
  const C3f value = eval(wo, wi);
  if (!(pdf > 0.0f) || is_black(value)) return std::nullopt;
  return BsdfSample{wi, value * (1.0f / pdf), pdf, through ? eta : 1.0f, false};
}

Principled Principled::without_diffuse() const {
  Principled rest = *this;
  rest.has_diffuse = false;
  rest.diffuse_reflectance_sampling_rate = 0.0f;
  return rest;
}

C3f Principled::diffuse_reflectance() const {
  if (!has_diffuse) return C3f(0.0f);
  const float opaque = opaque_weight();
  if (opaque == 0.0f) return C3f(0.0f);
  const C3f albedo = base_color * (opaque * burley_diffuse_albedo(roughness, flatness)) +
                     tint(base_color, sheen_tint) * (sheen * (1.0f - metallic) * sheen_albedo);
  return {std::min(albedo.x, 1.0f), std::min(albedo.y, 1.0f), std::min(albedo.z, 1.0f)};
}

}  // namespace twopass
