// What makes a render this one and no other, in words and fingerprints: all that its samples depend on.
#pragma once

#include <optional>

#include "integrators/make_integrator.h"
#include "render/load/load.h"
#include "render/partial_render.h"

namespace twopass {

struct IdentityFacts {
  const Scene& scene;
  const Solution* solution;  ///< null: none is read
  IntegratorKind integrator;
  PathLimits limits;
  V2i size;  ///< of the whole picture
  PixelWindow window;
  const Filter& filter;
  SamplerKind sampler;
  std::uint32_t strata;  ///< samples of a pixel in all parts, of stratified samplers
  std::uint32_t seed;
  const CameraDescription& camera;
  RayCone cone;
  const FilmLayout& layout;
};

RenderIdentity identity_of(const IdentityFacts& facts);

}  // namespace twopass
