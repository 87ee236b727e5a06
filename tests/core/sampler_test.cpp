#include "render/core/sampler.h"

#include <array>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/statistics.h"

namespace twopass {
namespace {

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

// In every pair, not in the first alone, and in any aligned block. The second pair of a group is not quite as
// good: of 2^m points, four lie in each elementary interval of area 2^(2-m). Each dimension alone is perfect.
TEST(Sampler, EveryPairIsANetAndEveryDimensionToo) {
  for (std::uint32_t pair = 0; pair < Sampler::sobol_pairs; ++pair) {
    const int t = pair % 2 == 0 ? 0 : 2;
    for (int m = t; m <= 8; ++m)
      for (int split = 0; split <= m - t; ++split) {
        std::map<std::uint32_t, int> cells;
        std::set<std::uint32_t> columns, rows;
        for (std::uint32_t i = 3u << m; i < 4u << m; ++i) {
          Sampler sampler(9, 77, i);
          for (std::uint32_t k = 0; k < pair; ++k) sampler.next_2d();
          const V2f u = sampler.next_2d();
          const auto cx = static_cast<std::uint32_t>(u.x * static_cast<float>(1 << split));
          const auto cy = static_cast<std::uint32_t>(u.y * static_cast<float>(1 << (m - t - split)));
          ++cells[cx << 16 | cy];
          columns.insert(static_cast<std::uint32_t>(u.x * static_cast<float>(1 << m)));
          rows.insert(static_cast<std::uint32_t>(u.y * static_cast<float>(1 << m)));
        }
        EXPECT_EQ(cells.size(), 1u << (m - t)) << "pair " << pair << " m " << m << " split " << split;
        for (const auto& [cell, points] : cells) EXPECT_EQ(points, 1 << t) << pair << " " << m << " " << split;
        EXPECT_EQ(columns.size(), 1u << m);
        EXPECT_EQ(rows.size(), 1u << m);
      }
  }
}

// Whether a pair is drawn as one number or as two, the first is the same.
TEST(Sampler, OneNumberIsTheFirstOfAPair) {
  for (std::uint32_t i = 0; i < 100; ++i) {
    Sampler one(1, 2, i), two(1, 2, i);
    for (int pair = 0; pair < 4; ++pair) EXPECT_EQ(one.next_1d(), two.next_2d().x);
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

constexpr SamplerKind kinds[] = {SamplerKind::sobol, SamplerKind::independent, SamplerKind::stratified};

TEST(SamplerKinds, NamesAreThoseOfTheCommandLine) {
  for (const SamplerKind kind : kinds)
    EXPECT_EQ(
        value_of_name<SamplerKind>(sampler_names, name_of_value<SamplerKind>(sampler_names, kind), "", ""),
        kind);
}

// One sample in each cell of the grid, for every number of samples that is a product of two like numbers; in
// each block of as many samples, and in both shallow and deep pairs.
TEST(SamplerKinds, StratifiedSamplesTakeEveryCellOnce) {
  const struct {
    std::uint32_t samples, columns, rows;
  } grids[] = {{1, 1, 1}, {2, 1, 2}, {6, 2, 3}, {9, 3, 3}, {16, 4, 4}, {20, 4, 5}, {64, 8, 8}, {0, 4, 4}};
  for (const auto& grid : grids) {
    const std::uint32_t n = grid.columns * grid.rows;
    for (const std::uint32_t block : {0u, 1u, 5u}) {
      std::array<std::set<std::uint32_t>, 12> cells, lines;
      for (std::uint32_t i = block * n; i < (block + 1) * n; ++i) {
        Sampler sampler(3, 4, i, SamplerKind::stratified, grid.samples);
        for (std::size_t pair = 0; pair < cells.size(); ++pair) {
          const V2f u = sampler.next_2d();
          cells[pair].insert(static_cast<std::uint32_t>(u.x * static_cast<float>(grid.columns)) * 100 +
                             static_cast<std::uint32_t>(u.y * static_cast<float>(grid.rows)));
          lines[pair].insert(static_cast<std::uint32_t>(sampler.next_1d() * static_cast<float>(n)));
        }
      }
      for (std::size_t pair = 0; pair < cells.size(); ++pair) {
        EXPECT_EQ(cells[pair].size(), n) << grid.samples << " samples, block " << block << ", pair " << pair;
        EXPECT_EQ(lines[pair].size(), n) << grid.samples << " samples, block " << block << ", pair " << pair;
      }
    }
  }
}

// The order in which the cells are taken is random: each sample lands in each cell equally often, and two
// samples in each pair of cells.
TEST(SamplerKinds, StratifiedCellsAreTakenInRandomOrder) {
  constexpr std::uint32_t n = 6, streams = 60000;
  std::vector<double> first(n, 0.0), both(n * n, 0.0);
  for (std::uint32_t stream = 0; stream < streams; ++stream) {
    const auto cell = [&](std::uint32_t i) {
      Sampler sampler(1, stream, i, SamplerKind::stratified, n);
      const V2f u = sampler.next_2d();
      return static_cast<std::uint32_t>(u.x * 2.0f) + 2 * static_cast<std::uint32_t>(u.y * 3.0f);
    };
    const std::uint32_t a = cell(0), b = cell(4);
    first[a] += 1.0;
    both[a * n + b] += 1.0;
  }
  std::vector<double> expected(n * n, streams / (n * (n - 1.0)));
  for (std::uint32_t i = 0; i < n; ++i) expected[i * n + i] = 0.0;
  const double level = test::sidak(1e-3, 2);
  EXPECT_GT(test::chi2_test(first, std::vector<double>(n, streams / static_cast<double>(n))), level);
  EXPECT_GT(test::chi2_test(both, expected), level);
}

// Each sample of every kind alone is uniform, in shallow and deep dimensions: what makes every mean unbiased.
TEST(SamplerKinds, EachSampleIsUniformOverTheStreams) {
  constexpr int cells = 8;
  constexpr std::uint32_t streams = 10000;
  const std::vector<double> expected(cells * cells, streams / static_cast<double>(cells * cells));
  const std::uint32_t indices[] = {0, 1, 7, 63, 1000};
  const double level = test::sidak(1e-3, std::size(kinds) * std::size(indices) * 2);
  for (const SamplerKind kind : kinds)
    for (const std::uint32_t index : indices)
      for (const int skipped : {0, 9}) {
        std::vector<double> seen(cells * cells, 0.0);
        for (std::uint32_t stream = 0; stream < streams; ++stream) {
          Sampler sampler(17, stream, index, kind, 10);
          for (int k = 0; k < skipped; ++k) sampler.next_2d();
          const V2f u = sampler.next_2d();
          seen[static_cast<std::size_t>(u.x * cells) * cells + static_cast<std::size_t>(u.y * cells)] += 1.0;
        }
        EXPECT_GT(test::chi2_test(seen, expected), level)
            << name_of_value<SamplerKind>(sampler_names, kind) << " sample " << index << " after " << skipped;
      }
}

// The mean of a smooth function, over streams that are independent: a z-test, for every kind and also for
// numbers of samples that fill neither a net nor a grid.
TEST(SamplerKinds, MeansOfASmoothFunctionAreUnbiased) {
  const double exact = (std::exp(1.0) - 1.0) * std::sin(1.0);
  const int counts[] = {1, 3, 16, 37};
  const double level = test::sidak(1e-3, std::size(kinds) * std::size(counts));
  for (const SamplerKind kind : kinds)
    for (const int n : counts) {
      test::Estimate estimate;
      for (std::uint32_t stream = 0; stream < 2000; ++stream) {
        double mean = 0.0;
        for (int i = 0; i < n; ++i) {
          Sampler sampler(5, stream, static_cast<std::uint32_t>(i), kind, static_cast<std::uint32_t>(n));
          const V2f u = sampler.next_2d();
          mean += std::exp(u.x) * std::cos(u.y) / n;
        }
        estimate.add(mean);
      }
      // Numbers of 24 bits rounded down: half a step too low.
      const double z = std::max(std::abs(estimate.mean() - exact) - 0x1p-24, 0.0) / estimate.standard_error();
      EXPECT_GT(test::two_sided_p(z), level) << name_of_value<SamplerKind>(sampler_names, kind) << " " << n;
    }
}

// Independent samples err with variance s^2/n exactly; stratified ones with less, Sobol ones with least.
TEST(SamplerKinds, ErrorsAreRankedAsPromised) {
  const auto variance = [](SamplerKind kind) {
    test::Estimate estimate;
    for (std::uint32_t stream = 0; stream < 1000; ++stream) {
      double mean = 0.0;
      for (std::uint32_t i = 0; i < 64; ++i) {
        Sampler sampler(6, stream, i, kind, 64);
        const V2f u = sampler.next_2d();
        mean += u.x * u.y / 64.0;
      }
      estimate.add(mean);
    }
    return estimate.variance();
  };
  const double independent = variance(SamplerKind::independent), expected = (1.0 / 9.0 - 1.0 / 16.0) / 64.0;
  EXPECT_NEAR(independent / expected, 1.0, 0.2);  // 4.5 standard errors
  EXPECT_LT(variance(SamplerKind::stratified), independent / 20.0);
  EXPECT_LT(variance(SamplerKind::sobol), variance(SamplerKind::stratified) / 2.0);
}

TEST(SamplerKinds, ArePureFunctionsAndStreamsDiffer) {
  for (const SamplerKind kind : kinds) {
    Sampler a(5, 6, 7, kind, 16), b(5, 6, 7, kind, 16), other(5, 8, 7, kind, 16), next(5, 6, 8, kind, 16);
    const V2f u = a.next_2d();
    EXPECT_EQ(u, b.next_2d());
    EXPECT_NE(u, other.next_2d());
    EXPECT_NE(u, next.next_2d());
  }
}

}  // namespace
}  // namespace twopass
