// A rough metal: facets that reflect as a smooth conductor does (M7).
#pragma once

#include "materials/bsdf_sample.h"
#include "materials/fresnel.h"
#include "materials/microfacet.h"

namespace twopass {

struct RoughConductor {
  C3f eta{0.0f};  ///< index of refraction relative to the outside; eta 0 with k 1 is an ideal mirror
  C3f k{1.0f};    ///< extinction coefficient relative to the outside
  C3f specular_reflectance{1.0f};
  float alpha_u = 0.1f, alpha_v = 0.1f;  ///< roughness along the tangents, see MicrofacetDistribution
  Microfacet distribution = Microfacet::beckmann;

  [[nodiscard]] C3f eval(const V3f& wo, const V3f& wi) const { return evaluate(wo, wi).value; }
  [[nodiscard]] float pdf_w(const V3f& wo, const V3f& wi) const { return evaluate(wo, wi).pdf_w; }
  [[nodiscard]] BsdfValue evaluate(const V3f& wo, const V3f& wi) const {
    if (!(wi.z > 0.0f)) return {C3f(0.0f), 0.0f};
    const V3f m = unit(wo + wi);
    const MicrofacetDistribution::Reflection facet = facets().reflection_and_pdf_w(wo, wi, m);
    return {facet_reflectance(wo, m) * facet.value, facet.pdf_w};
  }
  [[nodiscard]] std::optional<BsdfSample> sample(const V3f& wo, const V2f& u) const {
    const MicrofacetDistribution surface = facets();
    const V3f m = surface.sample(wo, u), wi = reflect(wo, m);
    const float pdf = surface.reflection_pdf_w(wo, m);
    if (!(wi.z > 0.0f && pdf > 0.0f)) return std::nullopt;
    return BsdfSample{wi, facet_reflectance(wo, m) * surface.sample_weight(wo, wi, m), pdf, 1.0f, false};
  }
  [[nodiscard]] C3f diffuse_reflectance() const { return C3f(0.0f); }
  [[nodiscard]] bool is_specular() const { return false; }
  template <class Self, class Visit>
  static void visit_parameters(Self& self, Visit&& visit) {
    visit("eta", self.eta);
    visit("k", self.k);
    visit("specular_reflectance", self.specular_reflectance);
    visit("alpha_u", self.alpha_u);
    visit("alpha_v", self.alpha_v);
    visit("distribution", self.distribution);
  }

 private:
  [[nodiscard]] MicrofacetDistribution facets() const { return {distribution, alpha_u, alpha_v}; }
  [[nodiscard]] C3f facet_reflectance(const V3f& wo, const V3f& m) const {
    return specular_reflectance * fresnel_conductor(std::min(wo.dot(m), 1.0f), eta, k);
  }
};

}  // namespace twopass
