// <transform> elements to matrices.
#pragma once

#include "render/core/types.h"
#include "render/load/mitsuba_document.h"

namespace twopass {

/// The product of the steps (translate, scale, rotate, lookat, matrix), the first one applied first, as a
/// matrix for row vectors (Imath): p_world = p * M. Throws Error with file:line for malformed, unknown or
/// perspective steps.
M44d parse_transform(const XmlNode& node);

}  // namespace twopass
