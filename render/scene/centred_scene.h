// A scene moved to the origin and scaled to about unit size without changing a digit of its coordinates.
#pragma once

#include "render/scene/scene.h"

namespace twopass {

/// The same scene in coordinates that rays and floats like: rays start a few units in the last place of the
/// largest coordinate above a surface, which far from the origin is more than what there is to see; and
/// products of lengths and of their inverses leave the range of floats where scenes are tiny or huge. Only
/// steps that floats represent exactly are taken: along each axis by a float, where the scene is farther from 0
/// than it is large, and in size by a power of two. So all scenes that differ by a power of two become the same
/// one, bit for bit, with another `frame`. Camera, lights and the heights of bump maps go along; radiances are
/// what they were.
SceneDescription centred(SceneDescription scene);

}  // namespace twopass
