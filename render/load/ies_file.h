// Photometric files of luminaires: IESNA LM-63 of 1986, 1991, 1995 and 2002 (.ies).
#pragma once

#include <filesystem>
#include <string_view>

#include "render/scene/ies_profile.h"

namespace twopass {

/// Reads a file of photometric type C. Multiplier and ballast factors are applied: the profile is in candela.
/// Throws Error (file:line) for a missing or malformed file, photometric types A and B, and lamps whose light
/// depends on the tilt of the luminaire.
IesProfile read_ies(const std::filesystem::path& path);

/// The same of a file's text; `name` is what errors call it.
IesProfile parse_ies(std::string_view text, std::string_view name);

}  // namespace twopass
