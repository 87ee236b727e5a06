// Random numbers that are a pure function of (seed, stream, sample index, dimension): Owen-scrambled Sobol
// points in pairs of dimensions. Knows no pixel; a stream is whatever the caller numbers (a pixel, an element).
#pragma once

#include <cstdint>

#include "render/core/types.h"

namespace twopass {

/// A well-mixed 64-bit hash of two words (the finaliser of SplitMix64, Steele et al. 2014).
inline std::uint64_t hash_words(std::uint32_t a, std::uint32_t b) {
  std::uint64_t h = (static_cast<std::uint64_t>(a) << 32 | b) * 0x9e3779b97f4a7c15u + 0x7f4a7c15f39cc060u;
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
  return h ^ (h >> 31);
}

/// The point `index` of the first two Sobol dimensions as 32-bit fractions, each Owen-scrambled by its seed
/// (Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020).
void owen_sobol_2d(std::uint32_t index, std::uint32_t seed_x, std::uint32_t seed_y, std::uint32_t& x,
                   std::uint32_t& y);

/// One sample's source of numbers in [0, 1). Dimensions are drawn in pairs; each pair is a scrambled and
/// shuffled (0,2)-sequence over the sample index, independent between streams.
class Sampler {
 public:
  Sampler(std::uint32_t seed, std::uint32_t stream, std::uint32_t index)
      : key_(static_cast<std::uint32_t>(hash_words(seed, stream))), index_(index) {}

  V2f next_2d();
  float next_1d() { return next_2d().x; }

 private:
  std::uint32_t key_;
  std::uint32_t index_;
  std::uint32_t pair_ = 0;
};

}  // namespace twopass
