// The scattering models that the suite in bsdf_test.cpp runs on. A new model is one line here for each of its
// regimes.
#pragma once

#include <ostream>
#include <string>

#include "materials/bsdf.h"

namespace twopass::test {

struct Case {
  std::string name;
  Bsdf unprepared;
  float alpha_u = 0.5f,
        alpha_v = 0.5f;  ///< about the width of the narrowest lobe, in slopes of the half vector
  float eta = 0.0f;      ///< where refraction peaks: index of refraction of the far side; 0 where it does not
  float albedo_max = 1.0f;  ///< what the model may return of uniform light

  /// The model, its tables prepared here alone: that takes a tenth of a second, which every start of a program
  /// that lists its cases would spend.
  Bsdf bsdf() const {
    Bsdf model = unprepared;
    if (auto* plastic = std::get_if<RoughPlastic>(&model)) plastic->prepare();
    return model;
  }
};

inline void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

inline Case rough_metal(std::string name, Microfacet distribution, float alpha_u, float alpha_v) {
  return {
      std::move(name),
      RoughConductor{C3f(0.2f, 0.9f, 1.1f), C3f(3.9f, 2.4f, 2.2f), C3f(1.0f), alpha_u, alpha_v, distribution},
      alpha_u, alpha_v};
}
inline Case rough_glass(std::string name, float eta, Microfacet distribution, float alpha_u, float alpha_v) {
  return {std::move(name),
          RoughDielectric{eta, C3f(0.9f), C3f(0.5f, 0.8f, 1.0f), alpha_u, alpha_v, distribution}, alpha_u,
          alpha_v, eta};
}
inline Case rough_plastic(std::string name, const C3f& base, float alpha, Microfacet distribution,
                          bool nonlinear) {
  return {std::move(name), RoughPlastic{1.49f, base, C3f(1.0f), alpha, distribution, nonlinear}, alpha, alpha};
}

inline const std::vector<Case>& cases() {
  constexpr Microfacet beckmann = Microfacet::beckmann, ggx = Microfacet::ggx;
  const C3f grey(0.5f), dark(0.2f), mixed(0.2f, 0.5f, 1.0f);
  static const std::vector<Case> table{
      {"diffuse", Diffuse{mixed}},
      {"black", Diffuse{C3f(0.0f)}},
      {"mirror", Conductor{}},
      {"metal", Conductor{C3f(0.2f, 0.9f, 1.1f), C3f(3.9f, 2.4f, 2.2f), C3f(1.0f)}},
      {"glass", Dielectric{}},
      {"glass_inside", Dielectric{1.0f / 1.5f, C3f(1.0f), C3f(1.0f)}},
      {"tinted_glass", Dielectric{1.5f, C3f(0.9f), C3f(0.1f, 0.5f, 0.9f)}},
      {"pane", ThinDielectric{}},
      {"null", Null{}},
      rough_metal("beckmann", beckmann, 0.1f, 0.1f),
      rough_metal("beckmann_wide", beckmann, 1.0f, 1.0f),
      rough_metal("beckmann_narrow", beckmann, 1e-3f, 1e-3f),
      rough_metal("beckmann_narrowest", beckmann, 1e-4f, 1e-4f),
      rough_metal("beckmann_brushed", beckmann, 0.05f, 0.4f),
      rough_metal("ggx", ggx, 0.1f, 0.1f),
      rough_metal("ggx_wide", ggx, 1.0f, 1.0f),
      rough_metal("ggx_narrow", ggx, 1e-3f, 1e-3f),
      rough_metal("ggx_narrowest", ggx, 1e-4f, 1e-4f),
      rough_metal("ggx_brushed", ggx, 0.4f, 0.05f),
      rough_glass("ground_glass", 1.5f, beckmann, 0.1f, 0.1f),
      rough_glass("ground_glass_inside", 1.0f / 1.5f, beckmann, 0.1f, 0.1f),
      rough_glass("ground_glass_narrow", 1.5f, beckmann, 1e-3f, 1e-3f),
      rough_glass("ground_glass_ggx", 1.5f, ggx, 0.3f, 0.3f),
      rough_glass("ground_glass_ggx_inside", 1.0f / 1.5f, ggx, 0.3f, 0.3f),
      rough_glass("ground_glass_brushed", 1.33f, ggx, 0.05f, 0.3f),
      {"plastic", Plastic{}},
      {"plastic_nonlinear", Plastic{1.9f, mixed, C3f(1.0f), true}},
      {"plastic_black", Plastic{1.5f, C3f(0.0f), C3f(1.0f), false}},
      {"plastic_uncoated", Plastic{1.5f, grey, C3f(0.0f), false}},
      rough_plastic("rough_plastic", grey, 0.1f, beckmann, false),
      rough_plastic("rough_plastic_ggx", mixed, 0.3f, ggx, true),
      rough_plastic("rough_plastic_narrow", grey, 1e-3f, ggx, false),
      rough_plastic("rough_plastic_black", C3f(0.0f), 0.3f, ggx, false),
      {"plaster", RoughDiffuse{}},
      {"plaster_rough", RoughDiffuse{mixed, 0.7f, false}},
      {"plaster_fast", RoughDiffuse{grey, 0.7f, true}},
      {"phong", Phong{}, 0.25f, 0.25f},
      {"phong_flat", Phong{grey, grey, 1.0f}},
      {"phong_narrow", Phong{grey, dark, 2000.0f}, 0.03f, 0.03f},
      {"phong_black", Phong{C3f(0.0f), C3f(0.0f), 30.0f}},
      // Ward's own normalisation exceeds the specular reflectance at grazing angles, Duer's without bound.
      {"ward", Ward{grey, dark, 0.1f, 0.1f, WardVariant::ward}, 0.1f, 0.1f, 0.0f, infinity_f},
      {"ward_duer", Ward{grey, dark, 0.1f, 0.3f, WardVariant::duer}, 0.1f, 0.3f, 0.0f, infinity_f},
      {"ward_balanced", Ward{grey, grey, 0.2f, 0.2f, WardVariant::balanced}, 0.2f, 0.2f},
      {"ward_brushed", Ward{grey, grey, 0.02f, 0.2f, WardVariant::balanced}, 0.02f, 0.2f},
      {"ward_metal", Ward{C3f(0.0f), C3f(1.0f), 0.1f, 0.1f, WardVariant::balanced}, 0.1f, 0.1f},
  };
  return table;
}

}  // namespace twopass::test
