// Mitsuba's disks and cylinders.
#pragma once

#include "render/load/mitsuba_properties.h"
#include "render/scene/shape.h"

namespace twopass {

/// The unit disk at `to_world`, which may make it an ellipse. Throws Error with file:line for what has no area.
Disk read_mitsuba_disk(Properties& properties);
/// From `p0` to `p1` with `radius`, then at `to_world`, which must keep it a cylinder. Throws Error with
/// file:line.
Cylinder read_mitsuba_cylinder(Properties& properties);

}  // namespace twopass
