// What evaluating and sampling a scattering model return.
//
// Conventions of the room: directions are unit vectors in the local frame of the surface, pointing away from
// it, with +z along the shading normal on the side of the viewer. So wo.z > 0 always; wi.z < 0 is transmission.
// Each side of a surface has its own model (materials/material.h), so no model ever asks on which side it is.
#pragma once

#include <optional>

#include "render/core/types.h"

namespace twopass {

/// What a model says of one pair of directions, without Dirac parts.
struct BsdfValue {
  C3f value;    ///< f(wo, wi) |wi.z|
  float pdf_w;  ///< density of sample() in solid angle
};

struct BsdfSample {
  V3f wi;            ///< direction towards the light
  C3f weight;        ///< f(wo, wi) |wi.z| / pdf
  float pdf_w;       ///< density in solid angle; for a specular direction, the probability of having chosen it
  float eta;         ///< relative index of refraction along the path: 1 for reflection
  bool is_specular;  ///< a Dirac delta: cannot be evaluated, only sampled
};

}  // namespace twopass
