// <shape> elements to shapes in world space.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "render/load/mitsuba_bsdfs.h"
#include "render/load/notes.h"
#include "render/scene/shape.h"

namespace twopass {

/// A <shape> element.
struct NamedShape {
  const XmlNode* node;
  std::string name;        ///< that it has where it has no id
  bool is_member = false;  ///< of a group, and so no instance itself
};
using NamedShapes = std::vector<NamedShape>;

/// The shapes that the elements describe, in their order, with their materials and what they emit. Materials
/// and lights are read first, then all meshes in parallel, those of the same file and options once: large ones
/// are instances of one mesh where nothing but their transforms (similarities) differs. Shapes none of whose
/// triangles has an area come back without triangles. Throws Error with file:line for what is not supported:
/// the one that reading one after the other would have met first.
std::vector<Shape> read_mitsuba_shapes(const NamedShapes& elements, const MitsubaTree& tree,
                                       MitsubaMaterials& materials, MitsubaTextures& textures, Notes& notes);

}  // namespace twopass
