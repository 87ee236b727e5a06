// What of a scattering model is diffuse, and what colour it has: for the layers of a picture, and for a
// solution that holds diffuse light.
#pragma once

#include "materials/material.h"

namespace twopass {

/// The part of eval(wo, wi) that diffuse lobes of reflection make, by channel; the rest is glossy or
/// transmitted.
inline C3f eval_diffuse(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
  return visit_model(bsdf, [&]<class Model>(const Model& model) {
    if constexpr (requires { model.eval_diffuse(wo, wi); })
      return wi.z > 0.0f ? model.eval_diffuse(wo, wi) : C3f(0.0f);
    else
      // Such models are all diffuse, but for Dirac parts that eval() leaves out, or not at all.
      return is_black(model.diffuse_reflectance()) ? C3f(0.0f) : model.eval(wo, wi);
  });
}

/// The same as a share of eval(wo, wi), in [0, 1]; 0 where that is black.
inline C3f diffuse_share(const Bsdf& bsdf, const V3f& wo, const V3f& wi) {
  const C3f all = eval(bsdf, wo, wi), diffuse = eval_diffuse(bsdf, wo, wi);
  C3f share(0.0f);
  for (int c = 0; c < 3; ++c)
    if (all[c] > 0.0f) share[c] = std::clamp(diffuse[c] / all[c], 0.0f, 1.0f);
  return share;
}

/// What the diffuse lobes of reflection send towards wo of light that comes evenly from all around, over that
/// light's radiance: their albedo as seen from there. Nothing where there is no closed form.
inline std::optional<C3f> diffuse_albedo(const Bsdf& bsdf, const V3f& wo) {
  return visit_model(bsdf, [&](const auto& model) -> std::optional<C3f> {
    if constexpr (requires { model.diffuse_albedo(wo); })
      return model.diffuse_albedo(wo);
    else
      return std::nullopt;
  });
}

/// The model without its diffuse lobes of reflection, which draws from the others alone; black if there are no
/// others.
inline Bsdf without_diffuse(const Bsdf& bsdf) {
  return visit_model(bsdf, [](const auto& model) -> Bsdf {
    if constexpr (requires { model.without_diffuse(); })
      return model.without_diffuse();
    else
      return is_black(model.diffuse_reflectance()) ? Bsdf(model) : Bsdf(Diffuse{C3f(0.0f)});
  });
}

/// Whether the side scatters otherwise than diffusely, somewhere; with or without doing that, too.
bool is_more_than_diffuse(const MaterialSide& side);

/// About what the surface returns of white light, in [0, 1]: the colour that a denoiser or a compositor takes
/// for that of the surface. Diffuse albedo plus the reflectance of mirrors and coats at normal incidence; glass
/// is white, times its tint. Exact for diffuse surfaces, independent of the direction for all.
C3f albedo(const Bsdf& bsdf);

}  // namespace twopass
