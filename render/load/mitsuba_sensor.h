// <sensor>, <film>, <sampler>, <rfilter> and <integrator>: the camera and what the file says about the picture.
#pragma once

#include "render/load/load.h"
#include "render/load/mitsuba_clip.h"
#include "render/load/mitsuba_expand.h"
#include "render/load/notes.h"

namespace twopass {

/// Reads a perspective sensor with what is nested in it. Throws Error with file:line for what is not supported.
CameraDescription read_mitsuba_sensor(const XmlNode& node, const MitsubaTree& tree, FileSettings& settings,
                                      ClipPlanes& clip, Notes& notes);

/// Reads an integrator's name and depths. A name that we do not know leaves settings.integrator unset, with a
/// note.
void read_mitsuba_integrator(const XmlNode& node, const MitsubaTree& tree, FileSettings& settings,
                             Notes& notes);

}  // namespace twopass
