// A scene moved to the origin and scaled to about unit size without changing a digit of its coordinates.
#pragma once

#include "render/scene/scene.h"

namespace twopass {

struct CentredScene {
  SceneDescription scene;
  double length_unit = 1.0;  ///< a length of 1 in `scene` is this long in the original; a power of two
};

/// The same geometry in coordinates that rays like: rays start a few units in the last place of the largest
/// coordinate above a surface, which far from the origin is more than what there is to see. Only steps that
/// floats represent exactly are taken: along each axis by a float, where the scene is farther from 0 than it is
/// large, and in size by a power of two.
CentredScene centred(const SceneDescription& scene);

}  // namespace twopass
