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

// The scrambled points refine the plain ones: the digit of the first scrambled bit is the first Sobol bit or
// its complement, for all indices alike.
TEST(Sampler, FirstBitsAreThoseOfSobolOrTheirComplement) {
  std::uint32_t x0, y0;
  owen_sobol_2d(0, 99, 77, x0, y0);
  for (std::uint32_t i = 0; i < 4096; ++i) {
    std::uint32_t x, y;
    owen_sobol_2d(i, 99, 77, x, y);
    EXPECT_EQ((y ^ y0) >> 31, sobol_dimension_1(i) >> 31);
    EXPECT_EQ((x ^ x0) >> 31, i & 1);
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

// Different pairs of one stream, and the same pair of different streams, must not be correlated.
TEST(Sampler, PairsAndStreamsAreUncorrelated) {
  constexpr int n = 1 << 14;
  double between_pairs = 0.0, between_streams = 0.0;
  for (std::uint32_t i = 0; i < n; ++i) {
    Sampler a(1, 2, i), b(1, 3, i);
    const float first = a.next_1d() - 0.5f, second = a.next_1d() - 0.5f, other = b.next_1d() - 0.5f;
    between_pairs += first * second;
    between_streams += first * other;
  }
  // Under independence the correlation has standard deviation 1 / sqrt(n); five of them.
  const double limit = 5.0 / 12.0 * std::sqrt(static_cast<double>(n));
  EXPECT_LT(std::abs(between_pairs), limit);
  EXPECT_LT(std::abs(between_streams), limit);
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
