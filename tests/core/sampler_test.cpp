#include "render/core/sampler.h"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/statistics.h"

namespace twopass {
namespace {

// Direction numbers of the second Sobol dimension from its recurrence: v_j = v_{j-1} xor (v_{j-1} >> 1).
std::uint32_t sobol_dimension_1(std::uint32_t index) {
  std::uint32_t v = 0x80000000u, result = 0;
  for (int bit = 0; bit < 32; ++bit) {
    if (index >> bit & 1) result ^= v;
    v ^= v >> 1;
  }
  return result;
}

// Owen scrambling keeps what makes Sobol points good: of 2^m points, one lies in each elementary interval of
// area 2^-m.
TEST(Sampler, PairsAreZeroTwoSequencesForEverySeed) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    for (int m = 1; m <= 8; ++m) {
      for (int split = 0; split <= m; ++split) {
        std::set<std::uint32_t> cells;
        for (std::uint32_t i = 0; i < (1u << m); ++i) {
          Sampler sampler(seed, seed * 7919, i);
          const V2f u = sampler.next_2d();
          const auto cx = static_cast<std::uint32_t>(u.x * static_cast<float>(1 << split));
          const auto cy = static_cast<std::uint32_t>(u.y * static_cast<float>(1 << (m - split)));
          cells.insert(cx << 16 | cy);
        }
        EXPECT_EQ(cells.size(), 1u << m) << "seed " << seed << " m " << m << " split " << split;
      }
    }
  }
}

TEST(Sampler, SecondDimensionIsSobols) {
  for (std::uint32_t i = 0; i < 100000; i += 7) {
    ASSERT_EQ(reverse_bits(sobol_dimension_1_reversed(i)), sobol_dimension_1(i)) << i;
  }
}

TEST(Sampler, ReversingTwiceChangesNothing) {
  EXPECT_EQ(reverse_bits(std::uint32_t{1}), 0x80000000u);
  EXPECT_EQ(reverse_bits(std::uint64_t{2}), std::uint64_t{1} << 62);
  EXPECT_EQ(reverse_bits(reverse_bits(std::uint32_t{0x12345678})), 0x12345678u);
}

// What makes it an Owen scramble: whether a bit is flipped depends on the bits above it alone.
TEST(Sampler, ScramblingKeepsSharedLeadingBits) {
  for (std::uint32_t i = 0; i < 4096; ++i) {
    const std::uint32_t x = static_cast<std::uint32_t>(hash_words(i, 1));
    for (int shared = 1; shared < 32; ++shared) {
      const std::uint32_t y = x ^ (1u << shared);  // differs in bit `shared`, agrees below (reversed order)
      const std::uint32_t difference = scramble_reversed(x, i * 77) ^ scramble_reversed(y, i * 77);
      ASSERT_EQ(difference & ((2u << shared) - 1u), 1u << shared);
    }
  }
}

TEST(Sampler, IsAPureFunctionOfSeedStreamIndexAndDimension) {
  Sampler a(5, 6, 7), b(5, 6, 7), other_seed(4, 6, 7), other_stream(5, 5, 7), other_index(5, 6, 8);
  const V2f u = a.next_2d();
  EXPECT_EQ(u, b.next_2d());
  EXPECT_NE(u, other_seed.next_2d());
  EXPECT_NE(u, other_stream.next_2d());
  EXPECT_NE(u, other_index.next_2d());
  EXPECT_NE(u, a.next_2d());
}

// The independent numbers of deep dimensions must differ between samples, or all paths of a pixel would end
// alike.
TEST(Sampler, DeepDimensionsAreUniformOverTheSamples) {
  constexpr int n = 1 << 14, cells = 8;
  std::vector<double> seen(cells * cells, 0.0),
      expected(cells * cells, static_cast<double>(n) / (cells * cells));
  for (std::uint32_t i = 0; i < n; ++i) {
    Sampler sampler(1, 2, i);
    for (std::uint32_t k = 0; k < Sampler::sobol_pairs; ++k) sampler.next_2d();
    const V2f u = sampler.next_2d();
    seen[static_cast<int>(u.x * cells) * cells + static_cast<int>(u.y * cells)] += 1.0;
  }
  EXPECT_GT(test::chi2_test(seen, expected), 1e-4);
}

// Different pairs of one stream, and the same pair of different streams, must not be correlated.
TEST(Sampler, PairsAndStreamsAreUncorrelated) {
  constexpr int n = 1 << 12, streams = 200;
  double pairs2 = 0.0,
         streams2 = 0.0;  // squared sums in units of their variance if all numbers were independent
  for (std::uint32_t k = 0; k < streams; ++k) {
    double between_pairs = 0.0, between_streams = 0.0;
    for (std::uint32_t i = 0; i < n; ++i) {
      Sampler a(1, 2 * k, i), b(1, 2 * k + 1, i);
      const float first = a.next_1d() - 0.5f, second = a.next_1d() - 0.5f, other = b.next_1d() - 0.5f;
      between_pairs += first * second;
      between_streams += first * other;
    }
    pairs2 += between_pairs * between_pairs * 144.0 / n / streams;
    streams2 += between_streams * between_streams * 144.0 / n / streams;
  }
  // Neighbouring indices fall into opposite halves in both, so that products come in equal pairs: up to 2
  // instead of 1. Correlated numbers would give n / 144 and more.
  EXPECT_LT(pairs2, 2.5);
  EXPECT_LT(streams2, 2.5);
}

// The point of it all: the error of a smooth integral falls much faster than 1/sqrt(N).
TEST(Sampler, SmoothIntegralsConvergeFasterThanRandomSampling) {
  const auto rms_error = [](int n) {
    double sum = 0.0;
    for (std::uint32_t stream = 0; stream < 100; ++stream) {
      double mean = 0.0;
      for (int i = 0; i < n; ++i) {
        Sampler sampler(3, stream, static_cast<std::uint32_t>(i));
        const V2f u = sampler.next_2d();
        mean += std::exp(u.x) * std::cos(u.y) / n;
      }
      const double error = mean - (std::exp(1.0) - 1.0) * std::sin(1.0);
      sum += error * error / 100;
    }
    return std::sqrt(sum);
  };
  // Random sampling gains a factor 8 from 16 to 1024 points; Owen-scrambled Sobol about 64^1.5 = 512.
  EXPECT_GT(rms_error(16) / rms_error(1024), 100.0);
}

TEST(Sampler, NumbersLieInTheHalfOpenUnitInterval) {
  for (std::uint32_t i = 0; i < 100000; ++i) {
    Sampler sampler(i, i * 31, i * 17);
    const V2f u = sampler.next_2d();
    ASSERT_TRUE(u.x >= 0.0f && u.x < 1.0f && u.y >= 0.0f && u.y < 1.0f);
  }
}

}  // namespace
}  // namespace twopass
