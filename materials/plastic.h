// Smooth plastic: a diffuse base under a clear smooth coat, with the light that bounces between them (M10).
#pragma once

#include "materials/bsdf_sample.h"
#include "materials/fresnel.h"
#include "materials/lobe_choice.h"
#include "render/core/warp.h"

namespace twopass {

/// What a diffuse base of this reflectance shows through a coat that lets the share `escape` > 0 of its light
/// out and reflects the rest back: the sum over all bounces. Unless `nonlinear`, the bounces do not tint: they
/// count as of a white base.
inline C3f base_after_bounces(const C3f& base_reflectance, float escape, bool nonlinear) {
  if (!nonlinear) return base_reflectance * (1.0f / escape);
  return base_reflectance / ((C3f(1.0f) - base_reflectance) + base_reflectance * escape);
}

/// Probability of sampling the coat, when it reflects `reflected` of the light and transmits the rest. NaN when
/// neither part reflects.
inline float coat_probability(float reflected, const C3f& specular_reflectance, const C3f& base_reflectance) {
  const float coat = reflected * mean_component(specular_reflectance),
              base = (1.0f - reflected) * mean_component(base_reflectance);
  return coat / (coat + base);
}

struct Plastic {
  float eta = 1.49f / 1.000277f;  ///< index of refraction of the coat over that of the outside
  C3f base_reflectance{0.5f};     ///< Mitsuba's diffuse_reflectance: of the base without its coat
  C3f specular_reflectance{1.0f};
  bool nonlinear = false;  ///< bounces under the coat tint: darker and more saturated

  [[nodiscard]] C3f eval(const V3f& wo, const V3f& wi) const {
    if (!(wi.z > 0.0f)) return C3f(0.0f);
    return base() * (transmitted(wo.z) * transmitted(wi.z) * cosine_hemisphere_pdf_w(wi.z));
  }
  [[nodiscard]] float pdf_w(const V3f& wo, const V3f& wi) const {
    const float coat = coat_probability(1.0f - transmitted(wo.z), specular_reflectance, base_reflectance);
    return coat < 1.0f ? (1.0f - coat) * cosine_hemisphere_pdf_w(wi.z) : 0.0f;
  }
  [[nodiscard]] std::optional<BsdfSample> sample(const V3f& wo, const V2f& u) const {
    const float through = transmitted(wo.z), reflected = 1.0f - through;
    const float coat = coat_probability(reflected, specular_reflectance, base_reflectance);
    if (!(coat >= 0.0f)) return std::nullopt;
    V2f rest = u;
    if (choose(rest.x, coat))
      return BsdfSample{V3f(-wo.x, -wo.y, wo.z), specular_reflectance * (reflected / coat), coat, 1.0f, true};
    const V3f wi = square_to_cosine_hemisphere(rest);
    if (!(wi.z > 0.0f)) return std::nullopt;
    return BsdfSample{wi, base() * (through * transmitted(wi.z) / (1.0f - coat)),
                      (1.0f - coat) * cosine_hemisphere_pdf_w(wi.z), 1.0f, false};
  }
  /// What the base reflects towards wo of light that comes evenly from all around.
  [[nodiscard]] C3f diffuse_albedo(const V3f& wo) const {
    return base() * (transmitted(wo.z) * (1.0f - fresnel_diffuse_reflectance(eta)));
  }
  /// The coat alone.
  [[nodiscard]] Plastic without_diffuse() const {
    Plastic bare = *this;
    bare.base_reflectance = C3f(0.0f);
    return bare;
  }
  /// Albedo of the base through its coat under uniform light.
  [[nodiscard]] C3f diffuse_reflectance() const {
    const float through = 1.0f - fresnel_diffuse_reflectance(eta);
    return base() * (through * through);
  }
  [[nodiscard]] bool is_specular() const { return false; }
  template <class Self, class Visit>
  static void visit_parameters(Self& self, Visit&& visit) {
    visit("eta", self.eta);
    visit("diffuse_reflectance", self.base_reflectance);
    visit("specular_reflectance", self.specular_reflectance);
    visit("nonlinear", self.nonlinear);
  }

 private:
  // The base after bounces; radiance that leaves the coat is divided by eta^2 (M2).
  [[nodiscard]] C3f base() const {
    return base_after_bounces(base_reflectance, fresnel_diffuse_escape(eta), nonlinear) * (1.0f / (eta * eta));
  }
  [[nodiscard]] float transmitted(float cosine) const {
    float cos_t;
    return 1.0f - fresnel_dielectric(cosine, eta, cos_t);
  }
};

}  // namespace twopass
