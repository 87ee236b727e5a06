// The values of Mitsuba's property elements: numbers, points, colours.
#pragma once

#include <initializer_list>
#include <string_view>
#include <vector>

#include "render/core/types.h"
#include "render/load/mitsuba_document.h"
#include "render/load/notes.h"

namespace twopass {

/// All functions throw Error with file:line for malformed values.

/// Throws for attributes that the element does not have.
void check_attributes(const XmlNode& node, std::initializer_list<std::string_view> known);

/// One finite number in an attribute.
double parse_number_attribute(const XmlNode& node, std::string_view attribute);
/// Numbers separated by blanks or commas.
std::vector<double> parse_numbers_attribute(const XmlNode& node, std::string_view attribute);

/// <point> or <vector>: value="x, y, z", value="x" (replicated), or x= y= z= (all three).
V3d parse_vector(const XmlNode& node);
bool parse_boolean(const XmlNode& node);
long long parse_integer_value(const XmlNode& node);

/// What a colour is for: it decides how spectra become three channels, and the range.
enum class ColorUse {
  reflectance,  ///< in [0, 1]; more is reduced to 1, and noted
  emission,     ///< 0 or more
  index,        ///< a conductor's eta or k: 0 or more; spectra are averaged like reflectances
};

/// <rgb>, <srgb>, <spectrum> or <float> as linear Rec.709, as Mitsuba's scalar_rgb does it. Old "#rrggbb" is
/// accepted; spectra that leave the gamut are clamped to what the use allows.
C3f parse_color(const XmlNode& node, ColorUse use, Notes& notes);
/// Of an object that is one colour, likewise.
C3f in_range(const C3d& color, const XmlNode& node, ColorUse use, Notes& notes);

}  // namespace twopass
