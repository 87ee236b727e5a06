// <shape> elements to shapes in world space.
#pragma once

#include "render/load/mitsuba_bsdfs.h"
#include "render/load/notes.h"
#include "render/scene/shape.h"

namespace twopass {

/// The shape that an element describes, with its material and what it emits. Its name is its id, or else
/// `name`; a mesh none of whose triangles has an area comes back without triangles. Throws Error with file:line
/// for what is not supported.
Shape read_mitsuba_shape(const XmlNode& node, const MitsubaTree& tree, const std::string& name,
                         MitsubaMaterials& materials, MitsubaTextures& textures, Notes& notes);

}  // namespace twopass
