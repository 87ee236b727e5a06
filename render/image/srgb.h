// The sRGB transfer curve (IEC 61966-2-1), for pictures stored as integers and for measures that look at a
// display.
#pragma once

#include <cmath>

namespace twopass {

/// Linear light to the encoded value, both 1 at white. REQUIRES: x >= 0.
inline float srgb_encode(float x) {
  return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
}
/// Encoded value to linear light. REQUIRES: x >= 0.
inline float srgb_decode(float x) { return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f); }

}  // namespace twopass
