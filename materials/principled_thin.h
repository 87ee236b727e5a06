// Disney's principled material for thin sheets: leaves, paper, coloured film.
//
// Burley 2015, section 5, with the choices of Mitsuba 3's plugin `principledthin` (M25). Both sides of a sheet
// have the same model.
#pragma once

#include "materials/bsdf_sample.h"

namespace twopass {

/// All parameters but eta and diff_trans are in [0, 1].
struct PrincipledThin {
  C3f base_color{0.5f};
  float roughness = 0.5f;
  float anisotropic = 0.0f;
  float spec_trans = 0.0f;  ///< 0: diffuse, 1: clear
  float eta = 1.5f;         ///< index of refraction of the sheet over what surrounds it
  float spec_tint = 0.0f;   ///< colours the mirror reflection
  float sheen = 0.0f;
  float sheen_tint = 0.0f;
  float flatness = 0.0f;    ///< blends the diffuse reflection into a flat subsurface
  float diff_trans = 0.0f;  ///< 0: diffuse light is reflected, 2: it is transmitted
  // How often each lobe is drawn: noise, never the mean.
  float diffuse_reflectance_sampling_rate = 1.0f;
  float specular_reflectance_sampling_rate = 1.0f;
  float specular_transmittance_sampling_rate = 1.0f;
  float diffuse_transmittance_sampling_rate = 1.0f;
  bool has_diffuse = true;  ///< false: without the diffuse and sheen lobes of reflection

  [[nodiscard]] C3f eval(const V3f& wo, const V3f& wi) const;
  /// The part of eval() that the diffuse and sheen lobes of reflection make. REQUIRES: wi.z > 0.
  [[nodiscard]] C3f eval_diffuse(const V3f& wo, const V3f& wi) const;
  [[nodiscard]] float pdf_w(const V3f& wo, const V3f& wi) const;
  [[nodiscard]] std::optional<BsdfSample> sample(const V3f& wo, const V2f& u) const;
  /// All lobes but the diffuse and the sheen of reflection.
  [[nodiscard]] PrincipledThin without_diffuse() const;
  /// Hemispherical average of the diffuse and sheen lobes of reflection, at most 1.
  [[nodiscard]] C3f diffuse_reflectance() const;
  [[nodiscard]] bool is_specular() const { return false; }
  [[nodiscard]] PrincipledThin from_behind() const { return *this; }
  [[nodiscard]] bool transmits() const { return spec_trans > 0.0f || diff_trans > 0.0f; }
  template <class Self, class Visit>
  static void visit_parameters(Self& self, Visit&& visit) {
    visit("base_color", self.base_color);
    visit("roughness", self.roughness);
    visit("anisotropic", self.anisotropic);
    visit("spec_trans", self.spec_trans);
    visit("eta", self.eta);
    visit("spec_tint", self.spec_tint);
    visit("sheen", self.sheen);
    visit("sheen_tint", self.sheen_tint);
    visit("flatness", self.flatness);
    visit("diff_trans", self.diff_trans);
    visit("diffuse_reflectance_sampling_rate", self.diffuse_reflectance_sampling_rate);
    visit("specular_reflectance_sampling_rate", self.specular_reflectance_sampling_rate);
    visit("specular_transmittance_sampling_rate", self.specular_transmittance_sampling_rate);
    visit("diffuse_transmittance_sampling_rate", self.diffuse_transmittance_sampling_rate);
  }

 private:
  struct LobeWeights;
  [[nodiscard]] LobeWeights lobe_weights() const;
  [[nodiscard]] C3f reflected_by_facets(const V3f& wo, const V3f& wi, const V3f& h) const;
  [[nodiscard]] C3f reflected_diffusely(const V3f& wo, const V3f& wi, const V3f& h) const;
  [[nodiscard]] C3f transmitted(const V3f& wo, const V3f& wi) const;
};

}  // namespace twopass
