// Which properties of a PLY element form an attribute together.
#pragma once

#include "render/load/ply_header.h"
#include "render/scene/shape.h"

namespace twopass {

/// One attribute of an element, and the properties that its three channels are read from.
struct PlyAttribute {
  std::string name;
  std::array<std::size_t, 3> property;  ///< three times the same one: a number
};

/// The attributes of the vertices (`prefix` "vertex_") or faces ("face_"), by Mitsuba's rules, apart from the
/// properties that are `reserved`.
std::vector<PlyAttribute> ply_attributes(const PlyElement& element, const std::string& prefix,
                                         const std::vector<std::string_view>& reserved);

/// A number of this type as Mitsuba reads it: integers as [0, 1] of what the type can hold, encoded in sRGB.
float ply_attribute_value(double number, PlyType type);

}  // namespace twopass
