// Oren and Nayar's model of rough matt surfaces: Lambertian facets in V-shaped grooves (M12).
#pragma once

#include "materials/bsdf_sample.h"

namespace twopass {

/// As in Mitsuba 0.6.
struct RoughDiffuse {
  C3f reflectance{0.5f};         ///< albedo of a facet, in [0, 1]
  float alpha = 0.2f;            ///< root mean square slope, as for microfacets; 0 is Lambert's reflection
  bool use_fast_approx = false;  ///< the paper's qualitative model: no light between the facets

  [[nodiscard]] C3f eval(const V3f& wo, const V3f& wi) const;
  [[nodiscard]] float pdf_w(const V3f& wo, const V3f& wi) const;
  [[nodiscard]] std::optional<BsdfSample> sample(const V3f& wo, const V2f& u) const;
  /// Albedo under uniform light: the model's mean over cosine-distributed pairs of directions.
  [[nodiscard]] C3f diffuse_reflectance() const;
  [[nodiscard]] bool is_specular() const { return false; }
  template <class Self, class Visit>
  static void visit_parameters(Self& self, Visit&& visit) {
    visit("reflectance", self.reflectance);
    visit("alpha", self.alpha);
    visit("use_fast_approx", self.use_fast_approx);
  }
};

}  // namespace twopass
