// Reading the radiosity solution: the only step in which an integrator trusts it.
#pragma once

#include "radiosity/solution.h"

namespace twopass {

/// Radiance that a surface of the given model reflects diffusely under the solution's irradiance (I5), W/(m2
/// sr).
inline C3f reflected_radiance(const Bsdf& bsdf, const Irradiance& irradiance) {
  return diffuse_reflectance(bsdf) * irradiance.total() * (1.0f / pi_f);
}

}  // namespace twopass
