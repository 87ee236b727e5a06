// Indices of refraction of metals and other absorbing substances by name.
#pragma once

#include <string_view>

#include "render/core/types.h"

namespace twopass {

/// Complex index of refraction eta + i k relative to vacuum, per channel.
struct ConductorIndex {
  C3f eta, k;
};

/// The index of `name` ("Au", "Cu_palik", ...; Mitsuba's names, and "none", an ideal mirror). The measured
/// spectra were reduced to channels as Mitsuba 3 does in RGB: like emitted light, so that an index of 1 at all
/// wavelengths would be (1.205, 0.948, 0.909) (M26). Throws Error at `where`, listing the known names.
ConductorIndex conductor_index_of(std::string_view name, std::string_view where);

}  // namespace twopass
