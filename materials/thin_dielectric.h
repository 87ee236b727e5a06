// A pane so thin that light goes through it straight: two parallel smooth interfaces in one surface (M9).
#pragma once

#include "materials/bsdf_sample.h"
#include "materials/fresnel.h"

namespace twopass {

struct ThinDielectric {
  float eta = 1.5046f / 1.000277f;  ///< index of refraction of the pane over that of what surrounds it
  C3f specular_reflectance{1.0f};
  C3f specular_transmittance{1.0f};

  [[nodiscard]] C3f eval(const V3f&, const V3f&) const { return C3f(0.0f); }
  [[nodiscard]] float pdf_w(const V3f&, const V3f&) const { return 0.0f; }
  [[nodiscard]] std::optional<BsdfSample> sample(const V3f& wo, const V2f& u) const {
    float cos_t;
    const float once = fresnel_dielectric(wo.z, eta, cos_t);
    const float reflected = 2.0f * once / (1.0f + once);
    if (u.x < reflected)
      return BsdfSample{V3f(-wo.x, -wo.y, wo.z), specular_reflectance, reflected, 1.0f, true};
    return BsdfSample{-wo, specular_transmittance, 1.0f - reflected, 1.0f, true};
  }
  [[nodiscard]] C3f diffuse_reflectance() const { return C3f(0.0f); }
  [[nodiscard]] bool is_specular() const { return true; }
  [[nodiscard]] ThinDielectric from_behind() const { return *this; }
  template <class Self, class Visit>
  static void visit_parameters(Self& self, Visit&& visit) {
    visit("eta", self.eta);
    visit("specular_reflectance", self.specular_reflectance);
    visit("specular_transmittance", self.specular_transmittance);
  }
};

}  // namespace twopass
