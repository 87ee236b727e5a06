// Rough plastic: a diffuse base under a clear coat with a rough outside (M11).
#pragma once

#include "materials/bsdf_sample.h"
#include "materials/coat_table.h"
#include "materials/fresnel.h"
#include "materials/lobe_choice.h"
#include "materials/plastic.h"
#include "render/core/warp.h"

namespace twopass {

/// A rough plastic as one viewer sees it: what does not depend on where light comes from, worked out once.
/// Inline and free of branches, so that a loop over many of them becomes vector instructions (M33).
struct RoughPlasticView {
  V3f wo;
  MicrofacetDistribution facets;
  float eta;
  C3f specular, base;      ///< the base after bounces, by what leaves the coat
  float through;           ///< of the light that leaves towards the viewer, what passes the coat
  float coat_probability;  ///< of drawing from the facets; NaN where there is nothing to draw

  /// Of a base of this reflectance under a coat that lets `escape` of its light out at once.
  static RoughPlasticView of(const V3f& wo, const MicrofacetDistribution& facets, float eta,
                             const C3f& specular, const C3f& base_reflectance, bool nonlinear, float escape,
                             float through) {
    // Radiance that leaves the coat is divided by eta^2 (M2).
    const C3f base = base_after_bounces(base_reflectance, escape, nonlinear) * (1.0f / (eta * eta));
    return {wo,
            facets,
            eta,
            specular,
            base,
            through,
            twopass::coat_probability(1.0f - through, specular, base_reflectance)};
  }
  /// `through_in`: of the light from `wi`, what passes the coat.
  [[nodiscard]] BsdfValue evaluate(const V3f& wi, float through_in) const {
    const V3f m = half_vector(wo, wi);
    float cos_t;
    const float reflected = fresnel_dielectric(std::min(wo.dot(m), 1.0f), eta, cos_t);
    const MicrofacetDistribution::Reflection facet = facets.reflection_and_pdf_w(wo, wi, m);
    const float cosine = cosine_hemisphere_pdf_w(wi.z), p = coat_probability;
    const float coat = wi.z > 0.0f ? reflected * facet.value : 0.0f;
    const float pdf_w = p * facet.pdf_w + (1.0f - p) * cosine;
    return {specular * coat + base * (through * through_in * cosine), wi.z > 0.0f && p >= 0.0f ? pdf_w : 0.0f};
  }
  /// Directions with the density of evaluate(): drawn from the facets with coat_probability, else from the
  /// base.
  [[nodiscard]] V3f draw_from_coat(const V2f& u) const { return reflect(wo, facets.sample(wo, u)); }
  [[nodiscard]] static V3f draw_from_base(const V2f& u) { return square_to_cosine_hemisphere(u); }
};

/// REQUIRES: prepare() after eta, alpha or distribution were set, before anything else is called.
struct RoughPlastic {
  float eta = 1.49f / 1.000277f;  ///< index of refraction of the coat over that of the outside
  C3f base_reflectance{0.5f};     ///< Mitsuba's diffuse_reflectance: of the base without its coat
  C3f specular_reflectance{1.0f};
  float alpha = 0.1f;  ///< roughness, see MicrofacetDistribution
  Microfacet distribution = Microfacet::beckmann;
  bool nonlinear = false;           ///< bounces under the coat tint: darker and more saturated
  const CoatTable* coat = nullptr;  ///< set by prepare()

  /// Finds the table of the coat: at once if it is there already.
  void prepare() {
    if (!coat || coat->alpha != alpha || coat->eta != eta || coat->distribution != distribution)
      coat = &coat_table(distribution, alpha, eta);
  }

  [[nodiscard]] C3f eval(const V3f& wo, const V3f& wi) const { return evaluate(wo, wi).value; }
  [[nodiscard]] float pdf_w(const V3f& wo, const V3f& wi) const { return evaluate(wo, wi).pdf_w; }
  [[nodiscard]] BsdfValue evaluate(const V3f& wo, const V3f& wi) const {
    return seen_from(wo).evaluate(wi, coat->transmittance_at(std::max(0.0f, wi.z)));
  }
  /// The part of eval() that the base makes. REQUIRES: wi.z > 0.
  [[nodiscard]] C3f eval_diffuse(const V3f& wo, const V3f& wi) const {
    const float through = coat->transmittance_at(wo.z) * coat->transmittance_at(wi.z);
    return base() * (through * cosine_hemisphere_pdf_w(wi.z));
  }
  [[nodiscard]] std::optional<BsdfSample> sample(const V3f& wo, const V2f& u) const;
  /// The sample of a direction that was drawn, by its evaluate().
  [[nodiscard]] static std::optional<BsdfSample> drawn(const V3f& wi, const BsdfValue& at) {
    if (!(at.pdf_w > 0.0f)) return std::nullopt;
    return BsdfSample{wi, at.value * (1.0f / at.pdf_w), at.pdf_w, 1.0f, false};
  }
  /// What the base reflects towards wo of light that comes evenly from all around.
  [[nodiscard]] C3f diffuse_albedo(const V3f& wo) const {
    return base() * (coat->transmittance_at(wo.z) * coat->mean_transmittance);
  }
  /// The coat alone.
  [[nodiscard]] RoughPlastic without_diffuse() const {
    RoughPlastic bare = *this;
    bare.base_reflectance = C3f(0.0f);
    return bare;
  }
  /// Albedo of the base through its coat under uniform light.
  [[nodiscard]] C3f diffuse_reflectance() const {
    return base() * (coat->mean_transmittance * coat->mean_transmittance);
  }
  [[nodiscard]] bool is_specular() const { return false; }
  template <class Self, class Visit>
  static void visit_parameters(Self& self, Visit&& visit) {
    visit("eta", self.eta);
    visit("diffuse_reflectance", self.base_reflectance);
    visit("specular_reflectance", self.specular_reflectance);
    visit("alpha", self.alpha);
    visit("distribution", self.distribution);
    visit("nonlinear", self.nonlinear);
  }

 private:
  [[nodiscard]] MicrofacetDistribution facets() const { return {distribution, alpha, alpha}; }
  // The base after bounces; radiance that leaves the coat is divided by eta^2 (M2).
  [[nodiscard]] C3f base() const {
    return base_after_bounces(base_reflectance, coat->escape, nonlinear) * (1.0f / (eta * eta));
  }
  [[nodiscard]] RoughPlasticView seen_from(const V3f& wo) const {
    return RoughPlasticView::of(wo, facets(), eta, specular_reflectance, base_reflectance, nonlinear,
                                coat->escape, coat->transmittance_at(wo.z));
  }
};

}  // namespace twopass
