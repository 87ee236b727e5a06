// Colours in other primaries.
#pragma once

#include <algorithm>
#include <array>

#include "render/core/types.h"

namespace twopass {

/// A linear map of colours, such as that from one set of primaries to another.
struct ColorMatrix {
  /// What red, green and blue of 1 become.
  std::array<C3f, 3> image{C3f(1.0f, 0.0f, 0.0f), C3f(0.0f, 1.0f, 0.0f), C3f(0.0f, 0.0f, 1.0f)};

  /// The colour in the new primaries; 0 where these cannot show it.
  [[nodiscard]] C3f operator()(const C3f& color) const {
    const C3f c = image[0] * color.x + image[1] * color.y + image[2] * color.z;
    return {std::max(c.x, 0.0f), std::max(c.y, 0.0f), std::max(c.z, 0.0f)};
  }
  /// The map that this one is of colours that are multiplied by `factor` only afterwards: what `f` makes of
  /// factor * c, over factor. Channels in which `factor` is 0 keep what they have.
  [[nodiscard]] ColorMatrix relative_to(const C3f& factor) const {
    ColorMatrix result;
    for (std::size_t from = 0; from < 3; ++from)
      for (int to = 0; to < 3; ++to)
        if (factor[to] != 0.0f)
          result.image[from][to] = image[from][to] * factor[static_cast<int>(from)] / factor[to];
    return result;
  }
  bool operator==(const ColorMatrix&) const = default;
};

}  // namespace twopass
