// The modified Phong model: a lobe around the mirror direction on a diffuse base (M13).
#pragma once

#include "materials/bsdf_sample.h"

namespace twopass {

struct Phong {
  C3f base_reflectance{0.5f};      ///< Mitsuba's diffuse_reflectance
  C3f specular_reflectance{0.2f};  ///< bounds the albedo of the lobe, which is less where the horizon cuts it
  float exponent = 30.0f;          ///< not negative

  [[nodiscard]] C3f eval(const V3f& wo, const V3f& wi) const;
  /// The part of eval() that the base makes. REQUIRES: wi.z > 0.
  [[nodiscard]] C3f eval_diffuse(const V3f& wo, const V3f& wi) const;
  [[nodiscard]] float pdf_w(const V3f& wo, const V3f& wi) const;
  [[nodiscard]] std::optional<BsdfSample> sample(const V3f& wo, const V2f& u) const;
  [[nodiscard]] C3f diffuse_albedo(const V3f&) const { return base_reflectance; }
  /// The lobe alone.
  [[nodiscard]] Phong without_diffuse() const {
    Phong bare = *this;
    bare.base_reflectance = C3f(0.0f);
    return bare;
  }
  [[nodiscard]] C3f diffuse_reflectance() const { return base_reflectance; }
  [[nodiscard]] bool is_specular() const { return false; }
  template <class Self, class Visit>
  static void visit_parameters(Self& self, Visit&& visit) {
    visit("diffuse_reflectance", self.base_reflectance);
    visit("specular_reflectance", self.specular_reflectance);
    visit("exponent", self.exponent);
  }
};

}  // namespace twopass
