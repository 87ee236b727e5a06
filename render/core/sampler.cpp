#include "render/core/sampler.h"

namespace twopass {

namespace {

std::uint32_t reverse_bits(std::uint32_t x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  return __builtin_bswap32(x);
}

// A permutation in which each bit depends only on itself and the bits below it: an Owen scramble of a number
// whose bits are reversed (Laine and Karras 2011; constants by Vegdahl 2021).
std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// The second Sobol dimension of index i, bits reversed: multiplication by Pascal's triangle modulo 2, a factor
// at a time.
std::uint32_t sobol_dimension_1_reversed(std::uint32_t i) {
  i ^= i >> 16;
  i ^= (i & 0xff00ff00u) >> 8;
  i ^= (i & 0xf0f0f0f0u) >> 4;
  i ^= (i & 0xccccccccu) >> 2;
  i ^= (i & 0xaaaaaaaau) >> 1;
  return i;
}

float to_unit_float(std::uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24f; }

}  // namespace

void owen_sobol_2d(std::uint32_t index, std::uint32_t seed_x, std::uint32_t seed_y, std::uint32_t& x,
                   std::uint32_t& y) {
  // The first Sobol dimension is the reversed index, so its reversed bits are the index itself.
  x = reverse_bits(scramble_reversed(index, seed_x));
  y = reverse_bits(scramble_reversed(sobol_dimension_1_reversed(index), seed_y));
}

V2f Sampler::next_2d() {
  const std::uint64_t seeds = hash_words(key_, pair_++);
  // Shuffling the index (itself an Owen scramble, so that every aligned block of 2^k samples stays one) makes
  // pairs independent.
  const std::uint32_t shuffled =
      reverse_bits(scramble_reversed(reverse_bits(index_), static_cast<std::uint32_t>(seeds >> 16)));
  std::uint32_t x, y;
  owen_sobol_2d(shuffled, static_cast<std::uint32_t>(seeds), static_cast<std::uint32_t>(seeds >> 32), x, y);
  return {to_unit_float(x), to_unit_float(y)};
}

}  // namespace twopass
