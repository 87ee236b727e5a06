// What an element receives.
#pragma once

#include <string>
#include <vector>

#include "render/core/types.h"

namespace twopass {

/// Power received by a unit of area, W/m2, without the surface's albedo.
struct Irradiance {
  C3f direct{0.0f};    ///< from emitters and sky, on the way perhaps reflected by specular surfaces (caustics)
  C3f indirect{0.0f};  ///< from diffuse surfaces, likewise
  [[nodiscard]] C3f total() const { return direct + indirect; }
};

/// What the light of each light group alone makes of it.
struct GroupedIrradiance {
  std::vector<std::string> names{};                 ///< of the groups
  std::vector<std::vector<Irradiance>> by_group{};  ///< a list a group, of every element
  [[nodiscard]] bool empty() const { return names.empty(); }
};

}  // namespace twopass
