// Disney's principled material: a metal, a plastic or a rough glass under a clear coat, mixed by weights.
//
// Burley 2012 (Physically Based Shading at Disney) and 2015 (Extending the Disney BRDF to a BSDF), with the
// choices of Mitsuba 3's plugin `principled`, whose pictures this model repeats (M20).
#pragma once

#include "materials/bsdf_sample.h"

namespace twopass {

/// Index of refraction of a surface that reflects 0.08 `specular` at normal incidence (M20).
float eta_of_specular(float specular);

/// All parameters but eta are in [0, 1].
struct Principled {
  C3f base_color{0.5f};
  float roughness = 0.5f;
  float anisotropic = 0.0f;
  float metallic = 0.0f;
  float spec_trans = 0.0f;            ///< 0: opaque base, 1: glass
  float eta = eta_of_specular(0.5f);  ///< index of refraction on the far side over the near side
  float spec_tint = 0.0f;             ///< colours the reflection of the plastic
  float sheen = 0.0f;
  float sheen_tint = 0.0f;
  float flatness = 0.0f;  ///< blends the diffuse reflection into a flat subsurface
  float clearcoat = 0.0f;
  float clearcoat_gloss = 0.0f;
  // How often each lobe is drawn: noise, never the mean.
  float diffuse_reflectance_sampling_rate = 1.0f;
  float main_specular_sampling_rate = 1.0f;
  float clearcoat_sampling_rate = 1.0f;
  bool inside = false;      ///< the viewer is behind the surface, where only the glass answers
  bool has_diffuse = true;  ///< false: without the diffuse and sheen lobes

  /// The model for the back of the same surface: only its glass, with the inverse index; black without glass.
  [[nodiscard]] Principled from_behind() const;
  [[nodiscard]] bool transmits() const { return spec_trans > 0.0f && metallic < 1.0f; }

  [[nodiscard]] C3f eval(const V3f& wo, const V3f& wi) const;
  /// The part of eval() that the diffuse and sheen lobes of reflection make. REQUIRES: wi.z > 0.
  [[nodiscard]] C3f eval_diffuse(const V3f& wo, const V3f& wi) const;
  [[nodiscard]] float pdf_w(const V3f& wo, const V3f& wi) const;
  [[nodiscard]] std::optional<BsdfSample> sample(const V3f& wo, const V2f& u) const;
  /// All lobes but the diffuse and the sheen.
  [[nodiscard]] Principled without_diffuse() const;
  /// Hemispherical average of the diffuse and sheen lobes, at most 1.
  [[nodiscard]] C3f diffuse_reflectance() const;
  [[nodiscard]] bool is_specular() const { return false; }
  template <class Self, class Visit>
  static void visit_parameters(Self& self, Visit&& visit) {
    visit("base_color", self.base_color);
    visit("roughness", self.roughness);
    visit("anisotropic", self.anisotropic);
    visit("metallic", self.metallic);
    visit("spec_trans", self.spec_trans);
    visit("spec_tint", self.spec_tint);
    visit("sheen", self.sheen);
    visit("sheen_tint", self.sheen_tint);
    visit("flatness", self.flatness);
    visit("clearcoat", self.clearcoat);
    visit("clearcoat_gloss", self.clearcoat_gloss);
    visit("eta", self.eta);
    visit("diffuse_reflectance_sampling_rate", self.diffuse_reflectance_sampling_rate);
    visit("main_specular_sampling_rate", self.main_specular_sampling_rate);
    visit("clearcoat_sampling_rate", self.clearcoat_sampling_rate);
    visit("inside", self.inside);
  }

 private:
  struct LobeWeights;
  [[nodiscard]] LobeWeights lobe_weights(float cos_o) const;
  [[nodiscard]] float opaque_weight() const;
  [[nodiscard]] float glass_weight() const;
  [[nodiscard]] C3f reflected_by_facets(const V3f& wo, const V3f& wi, const V3f& h) const;
  [[nodiscard]] C3f reflected_diffusely(const V3f& wo, const V3f& wi, const V3f& h) const;
  [[nodiscard]] C3f refracted(const V3f& wo, const V3f& wi) const;
};

}  // namespace twopass
