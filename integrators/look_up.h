// Reading the radiosity solution: the only step in which an integrator trusts it.
#pragma once

#include "radiosity/solution.h"
#include "radiosity/weights_from_afar.h"

namespace twopass {

/// Radiance that a surface of the given model reflects diffusely under the solution's irradiance (I5), W/(m2
/// sr).
inline C3f reflected_radiance(const Bsdf& bsdf, const Irradiance& irradiance) {
  return diffuse_reflectance(bsdf) * irradiance.total() * (1.0f / pi_f);
}

/// Whether an element is small enough for what is seen of it over the distance: nearer, contacts and corners
/// would be missed. False without an element.
inline bool resolves(const ElementMesh& mesh, std::uint32_t element, float distance) {
  if (element == no_index) return false;
  const float size = mesh.size(element);
  return size > 0.0f && distance >= contact_elements * size;  // 0: all of it is buried
}

}  // namespace twopass
