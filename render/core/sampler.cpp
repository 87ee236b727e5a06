#include "render/core/sampler.h"

#include <algorithm>
#include <bit>

namespace twopass {

namespace {

constexpr float below_one = 0x1.fffffep-1f;

// A random permutation of the numbers below n: in each round every number is paired with another, and a random
// bit of the pair says whether they change places ("swap or not", Hoang, Morris and Rogaway 2012).
std::uint32_t permute(std::uint32_t i, std::uint32_t n, std::uint64_t seed) {
  const int rounds = 8 + 2 * static_cast<int>(std::bit_width(n));
  for (int round = 0; round < rounds; ++round) {
    seed = hash_word(seed + 0x9e3779b97f4a7c15u);
    const std::uint32_t sum = static_cast<std::uint32_t>(seed >> 32) % n;
    const std::uint32_t partner = sum >= i ? sum - i : sum + n - i;
    if (hash_word(seed ^ std::max(i, partner)) & 1) i = partner;
  }
  return i;
}

// The cell of a sample: each `cells` samples in a row take them all, each time in another order.
std::uint32_t cell_of(std::uint32_t index, std::uint32_t cells, std::uint64_t seeds) {
  return permute(index % cells, cells, hash_word(seeds ^ std::uint64_t{index / cells} << 32));
}

}  // namespace

V2f Sampler::stratified_2d(std::uint64_t seeds, std::uint64_t random) const {
  const auto columns = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(samples_)));
  const std::uint32_t rows = samples_ / columns;
  const std::uint32_t cell = cell_of(reverse_bits(reversed_index_), columns * rows, seeds);
  const float x = static_cast<float>(cell % columns) + to_unit_float(static_cast<std::uint32_t>(random));
  const float y = static_cast<float>(cell / columns) + to_unit_float(static_cast<std::uint32_t>(random >> 32));
  return {std::min(x / static_cast<float>(columns), below_one),
          std::min(y / static_cast<float>(rows), below_one)};
}

float Sampler::stratified_1d(std::uint64_t seeds, std::uint64_t random) const {
  const std::uint32_t cell = cell_of(reverse_bits(reversed_index_), samples_, seeds);
  const float x = static_cast<float>(cell) + to_unit_float(static_cast<std::uint32_t>(random));
  return std::min(x / static_cast<float>(samples_), below_one);
}

}  // namespace twopass
