// <sensor>, <film>, <sampler>, <rfilter> and <integrator>: the camera and what the file says about the picture.
#pragma once

#include "render/load/load.h"
#include "render/load/mitsuba_expand.h"
#include "render/load/notes.h"

namespace twopass {

/// Reads a sensor (perspective, thinlens, orthographic) with what is nested in it. Throws Error with file:line
/// for what is not supported.
CameraDescription read_mitsuba_sensor(const XmlNode& node, const MitsubaTree& tree, FileSettings& settings,
                                      Notes& notes);

/// Reads an integrator's name and depths, those of the nested one where the plugin only adds outputs (aov,
/// moment, merge). A name that is not ours leaves settings.integrator unset, with a note.
void read_mitsuba_integrator(const XmlNode& node, const MitsubaTree& tree, FileSettings& settings,
                             Notes& notes);

}  // namespace twopass
