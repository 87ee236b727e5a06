// Random numbers that are a pure function of (seed, stream, sample index, dimension): Owen-scrambled Sobol
// points in pairs of dimensions, or two simpler kinds to compare them with. Knows no pixel; a stream is
// whatever the caller numbers (a pixel, an element).
#pragma once

#include <array>
#include <cstdint>

#include "render/core/names.h"
#include "render/core/types.h"

namespace twopass {

/// A well-mixed 64-bit hash of a word (the finaliser of SplitMix64, Steele et al. 2014).
inline std::uint64_t hash_word(std::uint64_t h) {
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
  return h ^ (h >> 31);
}
/// The same of two words.
inline std::uint64_t hash_words(std::uint32_t a, std::uint32_t b) {
  return hash_word((std::uint64_t{a} << 32 | b) * 0x9e3779b97f4a7c15u + 0x7f4a7c15f39cc060u);
}

/// Bits of the word in reverse order.
inline std::uint64_t reverse_bits(std::uint64_t x) {
  x = ((x >> 1) & 0x5555555555555555u) | ((x & 0x5555555555555555u) << 1);
  x = ((x >> 2) & 0x3333333333333333u) | ((x & 0x3333333333333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0f0f0f0f0fu) | ((x & 0x0f0f0f0f0f0f0f0fu) << 4);
  return __builtin_bswap64(x);
}
inline std::uint32_t reverse_bits(std::uint32_t x) {
  return static_cast<std::uint32_t>(reverse_bits(std::uint64_t{x}) >> 32);
}

/// A permutation in which each bit depends only on itself and the bits below it: an Owen scramble of a number
/// whose bits are reversed (Laine and Karras 2011; constants by Vegdahl 2021).
inline std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/// The second Sobol dimension of a point, bits reversed: its index times Pascal's triangle modulo 2, a factor
/// at a time. (The first dimension, bits reversed, is the index itself.)
inline std::uint32_t sobol_dimension_1_reversed(std::uint32_t index) {
  index ^= index >> 16;
  index ^= (index & 0xff00ff00u) >> 8;
  index ^= (index & 0xf0f0f0f0u) >> 4;
  index ^= (index & 0xccccccccu) >> 2;
  index ^= (index & 0xaaaaaaaau) >> 1;
  return index;
}

/// The third and the fourth Sobol dimension, reversed, in the low and the high half of a word: a table by byte
/// of the index, 8 KB. Direction numbers of Joe and Kuo 2008: x^2 + x + 1 from 1, 3; x^3 + x + 1 from 1, 3, 1.
class SobolTable {
 public:
  consteval SobolTable() {
    std::array<std::uint32_t, 32> third{1u << 31, 3u << 30}, fourth{1u << 31, 3u << 30, 1u << 29};
    for (std::size_t i = 2; i < 32; ++i) third[i] = third[i - 1] ^ third[i - 2] ^ third[i - 2] >> 2;
    for (std::size_t i = 3; i < 32; ++i) fourth[i] = fourth[i - 2] ^ fourth[i - 3] ^ fourth[i - 3] >> 3;
    for (std::size_t byte = 0; byte < 4; ++byte)
      for (std::size_t value = 0; value < 256; ++value)
        for (std::size_t bit = 0; bit < 8; ++bit)
          if (value >> bit & 1)
            entries_[byte][value] ^= reversed(third[8 * byte + bit], fourth[8 * byte + bit]);
  }
  [[nodiscard]] std::uint64_t operator()(std::uint32_t index) const {
    return entries_[0][index & 255] ^ entries_[1][index >> 8 & 255] ^ entries_[2][index >> 16 & 255] ^
           entries_[3][index >> 24];
  }

 private:
  static consteval std::uint64_t reversed(std::uint32_t low, std::uint32_t high) {
    std::uint64_t both = 0;
    for (int bit = 0; bit < 32; ++bit)
      both |= std::uint64_t{low >> bit & 1} << (31 - bit) | std::uint64_t{high >> bit & 1} << (63 - bit);
    return both;
  }
  std::array<std::array<std::uint64_t, 256>, 4> entries_{};
};
inline constexpr SobolTable sobol_dimensions_2_and_3_reversed;

/// How the numbers of the samples of one stream are spread.
enum class SamplerKind : std::uint8_t {
  sobol,        ///< every 2^k samples from a multiple of 2^k on are a (0,k,2)-net in each of the first pairs
  independent,  ///< not at all
  stratified    ///< one in each cell of a grid, in each pair
};

inline constexpr Named<SamplerKind> sampler_names[] = {
    {"sobol", SamplerKind::sobol},
    {"independent", SamplerKind::independent},
    {"stratified", SamplerKind::stratified},
};

/// One sample's source of numbers in [0, 1), drawn in pairs. Two pairs in a row are a point of the
/// four-dimensional Sobol sequence, Owen-scrambled; the order of the samples is shuffled from one such group to
/// the next and between streams, which makes them independent (Burley, "Practical Hash-based Owen Scrambling",
/// JCGT 9(4), 2020). Pairs after the first `sobol_pairs` are independent random numbers, which are cheaper;
/// stratified to the end, the Cornell box has 2 to 4 % less squared error at 16 to 64 samples. Inline: a path
/// draws a dozen. The other kinds begin behind the Sobol pairs, so that they cost those nothing.
///
/// Who draws what, in a path tracer: pair 0 the point on the film; then at each vertex one for the light (none
/// at a mirror) and one for the scattered direction. Film and first light share a group, and each scattered
/// direction and the next light. Roulette draws from rr_depth edges on, by default behind the Sobol pairs, so
/// that it does not shift them.
class Sampler {
 public:
  /// Stratified sampling has a grid of at most `samples` cells, as nearly square as that goes, for each so many
  /// samples; 16 cells where it is zero, because the number is not known. The other kinds do not use it.
  Sampler(std::uint32_t seed, std::uint32_t stream, std::uint32_t index, SamplerKind kind = SamplerKind::sobol,
          std::uint32_t samples = 0)
      : state_(hash_words(seed, stream)), reversed_index_(reverse_bits(index)) {
    if (kind == SamplerKind::sobol) return;
    pair_ = sobol_pairs;
    if (kind == SamplerKind::stratified) samples_ = samples > 0 ? samples : 16;
  }

  static constexpr std::uint32_t sobol_pairs = 8;

  V2f next_2d() {
    const std::uint64_t seeds = next_seeds();
    if (pair_++ >= sobol_pairs) {
      const std::uint64_t both = hash_word(seeds ^ reversed_index_);
      if (samples_ > 0) return stratified_2d(seeds, both);
      return {to_unit_float(static_cast<std::uint32_t>(both)),
              to_unit_float(static_cast<std::uint32_t>(both >> 32))};
    }
    std::uint64_t x, y;
    if (pair_ & 1) {
      index_ = shuffled_index(seeds);
      x = index_;
      y = sobol_dimension_1_reversed(index_);
    } else {
      const std::uint64_t xy = sobol_dimensions_2_and_3_reversed(index_);
      x = xy & 0xffffffffu;
      y = xy >> 32;
    }
    x = scramble_reversed(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(seeds));
    y = scramble_reversed(static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(seeds >> 32));
    const std::uint64_t both = reverse_bits(x << 32 | y);
    return {to_unit_float(static_cast<std::uint32_t>(both)),
            to_unit_float(static_cast<std::uint32_t>(both >> 32))};
  }
  float next_1d() {
    const std::uint64_t seeds = next_seeds();
    if (pair_++ >= sobol_pairs) {
      const std::uint64_t random = hash_word(seeds ^ reversed_index_);
      return samples_ > 0 ? stratified_1d(seeds, random) : to_unit_float(static_cast<std::uint32_t>(random));
    }
    if (pair_ & 1) index_ = shuffled_index(seeds);
    const auto x = pair_ & 1 ? index_ : static_cast<std::uint32_t>(sobol_dimensions_2_and_3_reversed(index_));
    return to_unit_float(reverse_bits(scramble_reversed(x, static_cast<std::uint32_t>(seeds))));
  }

 private:
  std::uint64_t next_seeds() { return hash_word(state_ += 0x9e3779b97f4a7c15u); }
  // Shuffling the index (itself an Owen scramble, so that every aligned block of 2^k samples stays one) makes
  // groups independent.
  [[nodiscard]] std::uint32_t shuffled_index(std::uint64_t seeds) const {
    return reverse_bits(scramble_reversed(reversed_index_, static_cast<std::uint32_t>(seeds >> 16)));
  }
  // A point of this sample's cell, placed in it by the random bits.
  [[nodiscard]] V2f stratified_2d(std::uint64_t seeds, std::uint64_t random) const;
  [[nodiscard]] float stratified_1d(std::uint64_t seeds, std::uint64_t random) const;
  static float to_unit_float(std::uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24f; }

  std::uint64_t state_;
  std::uint32_t reversed_index_;
  std::uint32_t index_ = 0;  // shuffled for the present group
  std::uint32_t pair_ = 0;
  std::uint32_t samples_ = 0;  // of the grid; zero: not stratified
};

}  // namespace twopass
