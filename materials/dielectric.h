// A perfectly smooth interface between two transparent media: mirror reflection and refraction (M2).
#pragma once

#include "materials/bsdf_sample.h"
#include "materials/fresnel.h"

namespace twopass {

struct Dielectric {
  float eta = 1.5046f / 1.000277f;  ///< index of refraction on the far side over the near side
  C3f specular_reflectance{1.0f};
  C3f specular_transmittance{1.0f};

  [[nodiscard]] C3f eval(const V3f&, const V3f&) const { return C3f(0.0f); }
  [[nodiscard]] float pdf_w(const V3f&, const V3f&) const { return 0.0f; }
  [[nodiscard]] std::optional<BsdfSample> sample(const V3f& wo, const V2f& u) const {
    float cos_t;
    const float reflected = fresnel_dielectric(wo.z, eta, cos_t);
    if (u.x < reflected)
      return BsdfSample{V3f(-wo.x, -wo.y, wo.z), specular_reflectance, reflected, 1.0f, true};
    // Radiance is compressed on refraction by 1 / eta^2: solid angle changes, power does not (M2).
    const float scale = 1.0f / eta;
    return BsdfSample{V3f(-wo.x * scale, -wo.y * scale, -cos_t), specular_transmittance * (scale * scale),
                      1.0f - reflected, eta, true};
  }
  [[nodiscard]] C3f diffuse_reflectance() const { return C3f(0.0f); }
  [[nodiscard]] bool is_specular() const { return true; }
  [[nodiscard]] Dielectric from_behind() const {
    return {1.0f / eta, specular_reflectance, specular_transmittance};
  }
  template <class Self, class Visit>
  static void visit_parameters(Self& self, Visit&& visit) {
    visit("eta", self.eta);
    visit("specular_reflectance", self.specular_reflectance);
    visit("specular_transmittance", self.specular_transmittance);
  }
};

}  // namespace twopass
