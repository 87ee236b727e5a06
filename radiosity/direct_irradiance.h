// Irradiance of the elements straight from emitters, without the sky and without reflections.
#pragma once

#include "radiosity/elements.h"
#include "radiosity/options.h"
#include "render/scene/scene.h"

namespace twopass {

struct DirectIrradiance {
  /// By element, W/m2: weighted by how much of light from there the element's material reflects diffusely
  /// (R50).
  std::vector<C3d> irradiance;
  /// By element, in units of area: what it exchanges with emitting sides that are no elements. Empty when the
  /// emitters were sampled (too many, or analytic surfaces).
  std::vector<double> exchange_with_lamps;
};

/// Up to `most_analytic_emitters` emitting triangles: analytic form factors times the visible fraction;
/// emitters are not divided. More of them, or analytic surfaces: sampled points on the lights and sampled
/// directions, combined by the balance heuristic. Punctual lights: `punctual_irradiance`. `conserve`: scale the
/// factors of each emitter so that all of its power arrives; for closed scenes in which every side is an
/// element. `rays` is increased. `least_rays`: towards emitters, of all elements together, where they are so
/// few that what is usual is less (16 shadow rays each, or 64 samples).
DirectIrradiance direct_irradiance(const Scene& scene, const ElementMesh& mesh, FormFactorMethod method,
                                   bool conserve, std::uint32_t seed, std::uint64_t& rays,
                                   std::size_t least_rays = 0);

inline constexpr std::size_t most_analytic_emitters = 16;

}  // namespace twopass
