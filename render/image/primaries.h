// Red, green, blue and white of linear colour spaces, and the way from one to another.
#pragma once

#include <span>
#include <string_view>

#include "render/core/color_matrix.h"
#include "render/core/names.h"

namespace twopass {

/// CIE 1931 chromaticities x, y.
struct Primaries {
  V2f red, green, blue, white;
  bool operator==(const Primaries&) const = default;
};

inline constexpr const char* rec709_id = "lin_rec709_scene";

/// Linear spaces by their names in "An ID for Color Interop" (Color Interop Forum), Annex A.
std::span<const Named<Primaries>> interop_spaces();
/// One of them, or null.
const Primaries* find_interop_space(std::string_view id);
/// The name of the space that linear Rec.709 becomes by this matrix, or empty. Adapted whites, as in
/// conversion().
std::string_view interop_id_of(const ColorMatrix& from_rec709);

/// A colour in other primaries, with negative parts where these cannot show it.
inline C3f linear_image(const ColorMatrix& matrix, const C3f& color) {
  return matrix.image[0] * color.x + matrix.image[1] * color.y + matrix.image[2] * color.z;
}
/// Colours of `from` in `to`. White becomes white, by the Bradford transform (ICC.1:2010, annex E).
ColorMatrix conversion(const Primaries& from, const Primaries& to);
/// The primaries of a space as seen under Rec.709's white. REQUIRES: the matrix has an inverse.
Primaries primaries_of(const ColorMatrix& to_rec709);

}  // namespace twopass
