#include "render/core/sampler.h"

#include <algorithm>
#include <array>
#include <bit>

namespace twopass {

namespace {

constexpr float below_one = 0x1.fffffep-1f;

// Four words side by side: the dimensions of a point.
using Words [[gnu::vector_size(16)]] = std::uint32_t;
using Bytes [[gnu::vector_size(16)]] = std::uint8_t;
using Ints [[gnu::vector_size(16)]] = std::int32_t;
using Floats [[gnu::vector_size(16)]] = float;

// A table by byte of the index, 16 KB, of the first four Sobol dimensions, their bits reversed. Direction
// numbers of Joe and Kuo 2008: Van der Corput's; x + 1 from 1; x^2 + x + 1 from 1, 3; x^3 + x + 1 from 1, 3, 1.
class SobolTable {
 public:
  consteval SobolTable() {
    std::array<std::array<std::uint32_t, 32>, 4> direction{};
    for (std::size_t i = 0; i < 32; ++i) direction[0][i] = 1u << (31 - i);
    auto& [first, second, third, fourth] = direction;
    second[0] = third[0] = fourth[0] = 1u << 31;
    third[1] = fourth[1] = 3u << 30;
    fourth[2] = 1u << 29;
    for (std::size_t i = 1; i < 32; ++i) second[i] = second[i - 1] ^ second[i - 1] >> 1;
    for (std::size_t i = 2; i < 32; ++i) third[i] = third[i - 1] ^ third[i - 2] ^ third[i - 2] >> 2;
    for (std::size_t i = 3; i < 32; ++i) fourth[i] = fourth[i - 2] ^ fourth[i - 3] ^ fourth[i - 3] >> 3;
    for (std::size_t byte = 0; byte < 4; ++byte)
      for (std::size_t value = 0; value < 256; ++value)
        for (std::size_t bit = 0; bit < 8; ++bit)
          for (std::size_t k = 0; k < 4; ++k)
            if (value >> bit & 1) entries_[byte][value].dimension[k] ^= reversed(direction[k][8 * byte + bit]);
  }
  [[nodiscard]] Words operator()(std::uint32_t index) const {
    return entry(0, index) ^ entry(1, index >> 8) ^ entry(2, index >> 16) ^ entry(3, index >> 24);
  }

 private:
  struct alignas(16) Entry {
    std::array<std::uint32_t, 4> dimension{};
  };
  [[nodiscard]] Words entry(std::size_t byte, std::uint32_t value) const {
    return std::bit_cast<Words>(entries_[byte][value & 255]);
  }
  static consteval std::uint32_t reversed(std::uint32_t word) {
    std::uint32_t result = 0;
    for (int bit = 0; bit < 32; ++bit) result |= (word >> bit & 1) << (31 - bit);
    return result;
  }
  std::array<std::array<Entry, 256>, 4> entries_{};
};
constexpr SobolTable sobol_reversed;

Words reverse_bits(Words x) {
  x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
  x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
  x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
  const auto bytes = std::bit_cast<Bytes>(x);
  return std::bit_cast<Words>(
      __builtin_shufflevector(bytes, bytes, 3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12));
}

Floats to_unit_floats(Words x) {
  return __builtin_convertvector(std::bit_cast<Ints>(x >> 8), Floats) * 0x1p-24f;
}

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

V2f Sampler::next_group() {
  const std::uint64_t seeds = next_seeds(), more = hash_word(state_ + pair_step);
  // Shuffling the index (itself an Owen scramble, so that every aligned block of 2^k samples stays one) makes
  // groups independent.
  const std::uint32_t index =
      twopass::reverse_bits(scramble_reversed(reversed_index_, static_cast<std::uint32_t>(seeds >> 16)));
  const Words scrambles{static_cast<std::uint32_t>(seeds), static_cast<std::uint32_t>(seeds >> 32),
                        static_cast<std::uint32_t>(more), static_cast<std::uint32_t>(more >> 32)};
  const Floats u = to_unit_floats(reverse_bits(scramble_reversed(sobol_reversed(index), scrambles)));
  second_ = {u[2], u[3]};
  return {u[0], u[1]};
}

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
