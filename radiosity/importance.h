// What the light of each element means to a picture that sees it by way of others.
#pragma once

#include <span>
#include <vector>

#include "radiosity/balance.h"

namespace twopass {

/// By how much a picture changes, relative to itself and of the brightest channel, with the radiosity of each
/// element by way of the elements that the light comes to from there (R46), in m2/W. `radiosity`: a solution of
/// the balance; `parts`: the part of the picture that sees each element. REQUIRES: one each an element.
std::vector<double> indirect_importance(const Balance& balance, std::span<const C3d> radiosity,
                                        std::span<const double> parts);

}  // namespace twopass
