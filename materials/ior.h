// Indices of refraction of everyday substances by name.
#pragma once

#include <string_view>

namespace twopass {

/// Indices of refraction, relative to the other side, that materials can compute with; no substance is near the
/// ends.
inline constexpr float smallest_ior = 1e-3f, largest_ior = 1e3f;

/// Index of refraction at visible wavelengths of `name` ("bk7", "water", ...; Mitsuba's names). Throws Error at
/// `where`, listing the known names.
float ior_of(std::string_view name, std::string_view where);

}  // namespace twopass
