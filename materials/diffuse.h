// Lambert's diffuse reflection (M1).
#pragma once

#include "materials/bsdf_sample.h"
#include "render/core/warp.h"

namespace twopass {

struct Diffuse {
  C3f reflectance{0.5f};  ///< albedo in [0, 1]

  [[nodiscard]] C3f eval(const V3f&, const V3f& wi) const {
    return reflectance * (std::max(wi.z, 0.0f) * (1.0f / pi_f));
  }
  [[nodiscard]] float pdf_w(const V3f&, const V3f& wi) const { return cosine_hemisphere_pdf_w(wi.z); }
  [[nodiscard]] std::optional<BsdfSample> sample(const V3f&, const V2f& u) const {
    const V3f wi = square_to_cosine_hemisphere(u);
    if (wi.z <= 0.0f || is_black(reflectance)) return std::nullopt;
    return BsdfSample{wi, reflectance, cosine_hemisphere_pdf_w(wi.z), 1.0f, false};
  }
  [[nodiscard]] C3f diffuse_albedo(const V3f&) const { return reflectance; }
  [[nodiscard]] C3f diffuse_reflectance() const { return reflectance; }
  [[nodiscard]] bool is_specular() const { return false; }
  template <class Self, class Visit>
  static void visit_parameters(Self& self, Visit&& visit) {
    visit("reflectance", self.reflectance);
  }
};

}  // namespace twopass
