// Half floats to floats without a table: look-ups share the first-level cache with better things.
#pragma once

#include <bit>
#include <cstdint>

namespace twopass {

/// The value of a half float by its bits. REQUIRES: it is finite.
inline float value_of_half(std::uint16_t bits) {
  const std::uint32_t magnitude = std::uint32_t{bits & 0x7fffu} << 13,
                      sign = std::uint32_t{bits & 0x8000u} << 16;
  const float scaled = std::bit_cast<float>(magnitude) * 0x1p112f;  // makes up for the biases of the exponents
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(scaled) | sign);
}

}  // namespace twopass
