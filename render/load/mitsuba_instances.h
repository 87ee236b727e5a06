// Mitsuba's shape groups and their instances, as far as elements go.
#pragma once

#include <string>
#include <vector>

#include "render/load/mitsuba_expand.h"

namespace twopass {

/// The shapes in a <shape type="shapegroup">. Throws Error with file:line for a group without shapes or an id,
/// for groups and instances in it, and for shapes that emit.
std::vector<const XmlNode*> shapes_of_group(const XmlNode& group, const MitsubaTree& tree);

struct MitsubaInstance {
  const XmlNode* group;  ///< the shape group
  M44d to_world;
  std::string where;  ///< file:line of the transform
};
/// A <shape type="instance">. Throws Error with file:line unless it refers to one shape group.
MitsubaInstance read_mitsuba_instance(const XmlNode& instance, const MitsubaTree& tree);

}  // namespace twopass
