// The diffuse albedo of a part of a surface whose material varies over it.
#pragma once

#include "radiosity/elements.h"

namespace twopass {

/// Mean albedo of the diffuse part of `material` over a cell of a root, in [0, 1]: its sixteen parts of equal
/// size, each looked at through its own extent in texture coordinates. REQUIRES: the root is one of `shape`.
C3f mean_albedo(const Shape& shape, const MaterialSide& material, const ElementRoot& root,
                const ElementCell& cell);

}  // namespace twopass
