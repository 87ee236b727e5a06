// Loops over many numbers that become vector instructions, as wide as the processor has them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

/// Marks a function made of such loops: whatever it calls is inlined, and it is compiled twice, for TWOPASS_ISA
/// and for AVX2; the program takes the faster when it starts. Nothing is contracted, so that both give the same
/// bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__AVX2__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define TWOPASS_IN_LANES [[gnu::flatten, gnu::target_clones("default", "arch=x86-64-v3")]]
#else
#define TWOPASS_IN_LANES
#endif

namespace twopass {

/// As many lanes as are worked on together.
inline constexpr std::size_t block_size = 32;

/// One number of each lane, and one beyond them that may be written for nothing. Harmless until it is set.
struct alignas(64) Lanes : std::array<float, block_size + 1> {
  Lanes() { fill(1.0f); }
};

/// `count` lanes in whole vectors of any width, so that there is no rest to be done one by one.
inline std::size_t whole_vectors(std::size_t count) {
  constexpr std::size_t widest = 8;
  return std::min((count + widest - 1) / widest * widest, block_size);
}

}  // namespace twopass
