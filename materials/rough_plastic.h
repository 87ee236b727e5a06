// Rough plastic: a diffuse base under a clear coat with a rough outside (M11).
#pragma once

#include "materials/bsdf_sample.h"
#include "materials/coat_table.h"

namespace twopass {

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
  [[nodiscard]] BsdfValue evaluate(const V3f& wo, const V3f& wi) const;
  /// The part of eval() that the base makes. REQUIRES: wi.z > 0.
  [[nodiscard]] C3f eval_diffuse(const V3f& wo, const V3f& wi) const;
  [[nodiscard]] std::optional<BsdfSample> sample(const V3f& wo, const V2f& u) const;
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
  [[nodiscard]] C3f base() const;
  // The density of sample(), drawn from the facets with probability `p`, NaN where there is nothing to draw.
  [[nodiscard]] BsdfValue evaluate(const V3f& wo, const V3f& wi, float p) const;
  [[nodiscard]] float coat_probability_at(float cosine) const;
};

}  // namespace twopass
