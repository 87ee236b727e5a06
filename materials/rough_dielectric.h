// A rough interface between two transparent media, such as ground glass: facets that reflect and refract as a
// smooth dielectric does (M8).
#pragma once

#include "materials/bsdf_sample.h"
#include "materials/microfacet.h"

namespace twopass {

struct RoughDielectric {
  float eta = 1.5046f / 1.000277f;  ///< index of refraction on the far side over the near side. REQUIRES: not 1
  C3f specular_reflectance{1.0f};
  C3f specular_transmittance{1.0f};
  float alpha_u = 0.1f, alpha_v = 0.1f;  ///< roughness along the tangents, see MicrofacetDistribution
  Microfacet distribution = Microfacet::beckmann;

  [[nodiscard]] C3f eval(const V3f& wo, const V3f& wi) const;
  [[nodiscard]] float pdf_w(const V3f& wo, const V3f& wi) const;
  [[nodiscard]] std::optional<BsdfSample> sample(const V3f& wo, const V2f& u) const;
  [[nodiscard]] C3f diffuse_reflectance() const { return C3f(0.0f); }
  [[nodiscard]] bool is_specular() const { return false; }
  [[nodiscard]] RoughDielectric from_behind() const {
    RoughDielectric inside = *this;
    inside.eta = 1.0f / eta;
    return inside;
  }
  template <class Self, class Visit>
  static void visit_parameters(Self& self, Visit&& visit) {
    visit("eta", self.eta);
    visit("specular_reflectance", self.specular_reflectance);
    visit("specular_transmittance", self.specular_transmittance);
    visit("alpha_u", self.alpha_u);
    visit("alpha_v", self.alpha_v);
    visit("distribution", self.distribution);
  }

 private:
  [[nodiscard]] MicrofacetDistribution facets() const { return {distribution, alpha_u, alpha_v}; }
};

}  // namespace twopass
