// Reflection at smooth interfaces: Fresnel's formulas and refraction.
#pragma once

#include "render/core/types.h"

namespace twopass {

/// Unpolarised reflectance in [0, 1] of an interface to a dielectric (M2). `eta` is the index of refraction
/// behind the interface over the one in front; `cos_i` in [0, 1]. 1 beyond the critical angle. `cos_t` receives
/// the cosine of the refracted direction (0 under total reflection).
inline float fresnel_dielectric(float cos_i, float eta, float& cos_t) {
  const float sin2_t = std::max(0.0f, 1.0f - cos_i * cos_i) / (eta * eta);
  cos_t = std::sqrt(std::max(0.0f, 1.0f - sin2_t));
  const float s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  const float p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  return sin2_t >= 1.0f ? 1.0f : 0.5f * (s * s + p * p);
}

/// The reflectance of such an interface for diffuse light, the mean over the cosine: within 0.2 % for eta above
/// 1 (d'Eon and Irving 2011), within 0.1 % from 1 / 1.5 to 1 and 0.6 % from 1 / 2 on (Egan and Hilgeman 1973);
/// the fits that Mitsuba renders plastic with. Below 1 / 2, by reciprocity, from the other side (M10).
float fresnel_diffuse_reflectance(float eta);
/// 1 - fresnel_diffuse_reflectance(1 / eta), the share of the light from a diffuse base that leaves its coat,
/// without cancellation: above 0 for every eta in [1e-3, 1e3].
float fresnel_diffuse_escape(float eta);

/// Unpolarised reflectance of a conductor of complex index eta + i k relative to the outside, per channel (M3).
C3f fresnel_conductor(float cos_i, const C3f& eta, const C3f& k);

}  // namespace twopass
