// The surfaces that emit, in the pieces that particles are shot from.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "radiosity/pieces.h"
#include "render/core/distribution.h"
#include "render/scene/scene.h"

namespace twopass {

/// An emitting side of a triangle, or of a piece of an analytic surface.
struct LampSurface {
  Patch patch;
  C3f radiance;         ///< W/(m2 sr)
  std::uint32_t light;  ///< its number, as in Lights
  bool varies;          ///< `radiance` is the mean over the surface
};

/// All of the scene, by shape and side.
std::vector<LampSurface> lamp_surfaces(const Scene& scene);

/// A choice among them in proportion to their power.
DiscreteDistribution choice_by_power(std::span<const LampSurface> lamps);

/// The radiance that a lamp emits at a point of its patch; `rays` is increased where one is cast to see.
C3f radiance_at(const Scene& scene, const LampSurface& lamp, const ElementPoint& point, std::uint64_t& rays);

}  // namespace twopass
