// What an element receives.
#pragma once

#include "render/core/types.h"

namespace twopass {

/// Power received by a unit of area, W/m2, without the surface's albedo.
struct Irradiance {
  C3f direct{0.0f};    ///< from emitters and sky, on the way perhaps reflected by specular surfaces (caustics)
  C3f indirect{0.0f};  ///< from diffuse surfaces, likewise
  [[nodiscard]] C3f total() const { return direct + indirect; }
};

}  // namespace twopass
