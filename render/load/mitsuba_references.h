// References between the objects of a Mitsuba scene, checked before anything follows them.
#pragma once

#include "render/load/mitsuba_expand.h"

namespace twopass {

/// Throws Error with file:line when an object contains itself through references, when objects are nested more
/// than 100 deep through them, or when a bsdf, texture, integrator or the like would have more than 10000
/// objects in it if all its references were written out: a few lines that refer to each other twice grow
/// without bounds.
void check_references(const MitsubaTree& tree);

}  // namespace twopass
