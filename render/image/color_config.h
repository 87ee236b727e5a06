// The OpenColorIO configuration that serves when the user names none. A text without look-up tables.
#pragma once

#include <string_view>

namespace twopass {

/// An OpenColorIO 2 configuration: scene-linear is linear Rec.709; displays sRGB and Rec.1886; views
/// "Un-tone-mapped" (the default: pictures look as those of renderers that only apply the sRGB curve) and
/// "ACES 1.0 - SDR Video".
std::string_view builtin_ocio_config();

}  // namespace twopass
