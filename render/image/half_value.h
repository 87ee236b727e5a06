// Half floats to floats without a table: look-ups share the first-level cache with better things.
#pragma once

#include <bit>
#include <cstdint>

namespace twopass {

/// The value of a half float by its bits, or of several side by side. REQUIRES: they are finite.
template <class Real, class Word>
Real value_of_half(Word bits) {
  const Word magnitude = (bits & 0x7fffu) << 13, sign = (bits & 0x8000u) << 16;
  const Real scaled = std::bit_cast<Real>(magnitude) * 0x1p112f;  // makes up for the biases of the exponents
  return std::bit_cast<Real>(std::bit_cast<Word>(scaled) | sign);
}
inline float value_of_half(std::uint16_t bits) { return value_of_half<float>(std::uint32_t{bits}); }

}  // namespace twopass
