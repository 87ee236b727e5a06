// How much light passes a rough clear coat, by angle: integrals that rough plastic needs at every evaluation.
#pragma once

#include <array>

#include "materials/microfacet.h"

namespace twopass {

struct CoatTable {
  static constexpr int size = 64;

  Microfacet distribution;
  float alpha, eta;
  std::array<float, size> transmittance;  ///< of light from outside, at cosines i / (size - 1)
  float escape;                           ///< what of diffuse light from the base leaves at once; > 0
  float mean_transmittance;               ///< of diffuse light from outside

  /// Transmittance of light from outside at this cosine in [0, 1].
  [[nodiscard]] float transmittance_at(float cosine) const {
    const float x = cosine * (size - 1);
    const int i = std::min(static_cast<int>(x), size - 2);
    const float t = x - static_cast<float>(i);
    return (1.0f - t) * transmittance[i] + t * transmittance[i + 1];
  }
};

/// The table of a coat of this index of refraction (coat over outside). Tables are computed once (about 90 ms
/// (Beckmann) or 13 ms (GGX)) and kept until the program ends, so that models that point to them stay small and
/// cheap to copy: a shared owner would count references at every hit. REQUIRES: finite arguments.
const CoatTable& coat_table(Microfacet distribution, float alpha, float eta);

}  // namespace twopass
