// What a surface is made of: a scattering model for each of its two sides.
#pragma once

#include <array>
#include <string>

#include "materials/bsdf.h"

namespace twopass {

/// The side of a surface that its geometric normal points away from is the front.
enum Side : std::uint8_t { front = 0, back = 1 };

/// Models by side. One-sided models have a black back; `twosided` has a model on both; a dielectric has its
/// inverse index of refraction on the back.
struct Material {
  std::string name;
  std::array<Bsdf, 2> side{Diffuse{}, Diffuse{C3f(0.0f)}};
};

inline Material one_sided(std::string name, const Bsdf& bsdf) {
  return {std::move(name), {bsdf, Diffuse{C3f(0.0f)}}};
}
inline Material two_sided(std::string name, const Bsdf& front_bsdf, const Bsdf& back_bsdf) {
  return {std::move(name), {front_bsdf, back_bsdf}};
}
/// A closed or open interface; `outside` is the model seen from the front: Dielectric or RoughDielectric.
template <class Interface>
Material interface_material(std::string name, const Interface& outside) {
  Interface inside = outside;
  inside.eta = 1.0f / outside.eta;
  return {std::move(name), {outside, inside}};
}

}  // namespace twopass
