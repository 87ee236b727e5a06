// Choosing between two parts of a model with a random number that is used again afterwards.
#pragma once

#include <algorithm>

namespace twopass {

/// True with this probability. `u` in [0, 1) becomes the place within the chosen part, again uniform in [0, 1).
inline bool choose(float& u, float probability) {
  const bool chosen = u < probability;
  u = chosen ? u / probability : (u - probability) / (1.0f - probability);
  u = std::min(u, 1.0f - 0x1p-24f);  // a quotient may round to 1
  return chosen;
}

}  // namespace twopass
