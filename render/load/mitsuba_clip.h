// Clipping planes of Mitsuba's cameras. We have none, which matters only to scenes that reach past them.
#pragma once

#include <string>

#include "render/load/notes.h"
#include "render/scene/scene.h"

namespace twopass {

/// Depths along the view between which a sensor wants to see, as far as its file says.
struct ClipPlanes {
  double near = 0.0, far = infinity_f;
  std::string where;
};

/// Notes that a plane is not applied where something would be cut off by it. REQUIRES: the scene has a camera.
void note_clipping(const SceneDescription& scene, const ClipPlanes& clip, Notes& notes);

}  // namespace twopass
