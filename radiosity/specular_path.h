// Following light over specular surfaces to the first one that is not.
#pragma once

#include "render/core/sampler.h"
#include "render/scene/scene.h"

namespace twopass {

/// What a path over specular surfaces carries.
enum class Carried {
  radiance,  ///< traced against the light; shrinks by 1 / eta^2 on entering a denser medium, and grows on
             ///< leaving
  power,     ///< traced with the light; changes only by absorption
};

/// Where a path over specular surfaces ends.
struct SpecularPathEnd {
  C3f weight{0.0f};  ///< carried from end to end; black: absorbed on the way
  bool escaped = true;
  V3f direction{0.0f};  ///< of the last ray; only if it has escaped
  SurfacePoint point;   ///< of the first surface that is not specular; only if it has not escaped
  unsigned rays = 0;    ///< cast on the way
};

/// Continues a ray that has met a specular surface at `point` through reflections and refractions chosen at
/// random. A path is absorbed at random once it carries little, and after 64 surfaces.
SpecularPathEnd follow_specular(const Scene& scene, Ray ray, SurfacePoint point, Carried carried,
                                Sampler& sampler);

}  // namespace twopass
