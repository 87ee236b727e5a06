// A perfectly smooth metal: mirror reflection weighted by the conductor's Fresnel reflectance (M3).
#pragma once

#include "materials/bsdf_sample.h"
#include "materials/fresnel.h"

namespace twopass {

struct Conductor {
  C3f eta{0.0f};  ///< index of refraction relative to the outside; eta 0 with k 1 is an ideal mirror
  C3f k{1.0f};    ///< extinction coefficient relative to the outside
  C3f specular_reflectance{1.0f};

  [[nodiscard]] C3f eval(const V3f&, const V3f&) const { return C3f(0.0f); }
  [[nodiscard]] float pdf_w(const V3f&, const V3f&) const { return 0.0f; }
  [[nodiscard]] std::optional<BsdfSample> sample(const V3f& wo, const V2f&) const {
    const C3f weight = specular_reflectance * fresnel_conductor(wo.z, eta, k);
    return BsdfSample{V3f(-wo.x, -wo.y, wo.z), weight, 1.0f, 1.0f, true};
  }
  [[nodiscard]] C3f diffuse_reflectance() const { return C3f(0.0f); }
  [[nodiscard]] bool is_specular() const { return true; }
  template <class Self, class Visit>
  static void visit_parameters(Self& self, Visit&& visit) {
    visit("eta", self.eta);
    visit("k", self.k);
    visit("specular_reflectance", self.specular_reflectance);
  }
};

}  // namespace twopass
