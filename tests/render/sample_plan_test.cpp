#include "render/sample_plan.h"

#include <functional>

#include <gtest/gtest.h>

#include "render/core/sampler.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

using Value = std::function<double(int x, int y, std::uint64_t random)>;

double unit_number(std::uint64_t random) { return static_cast<double>(random >> 11) * 0x1p-53; }

// Renders by the plan, samples independent of one another. Returns why it stopped.
std::string render(Film& film, const SamplingGoal& goal, std::uint32_t seed, const Value& value) {
  SamplePlan plan(goal, film);
  while (plan.next()) {
    for (int y = 0; y < film.height(); ++y)
      for (int x = 0; x < film.width(); ++x) {
        PixelBatch batch;
        const SampleRange range = plan.range(x, y);
        for (std::uint32_t i = range.begin; i < range.end; ++i) {
          const auto pixel = static_cast<std::uint32_t>(y * film.width() + x);
          batch.add(C3f(static_cast<float>(
              value(x, y, hash_word(hash_words(seed, pixel) + (i + 1) * 0x9e3779b97f4a7c15u)))));
        }
        film.add_pixel(x, y, batch);
      }
  }
  return plan.stop_reason();
}

// 1 on average, seldom there, and the seldomer the further to the right.
double rare(int x, int, std::uint64_t random) {
  const double chance = 1.0 / (2.0 + x * x);
  return unit_number(random) < chance ? 1.0 / chance : 0.0;
}

Film pilot_of(int width, int height, int samples, const Value& value, std::uint32_t seed = 1) {
  Film film(width, height);
  for (int pass = 0; pass < samples / 8; ++pass)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        PixelBatch batch;
        for (int i = 0; i < 8; ++i)
          batch.add(C3f(static_cast<float>(value(
              x, y, hash_words(seed, static_cast<std::uint32_t>(((pass * height + y) * width + x) * 8 + i))))));
        film.add_pixel(x, y, batch);
      }
  return film;
}

TEST(SampleShares, EqualPixelsGetEqualSamples) {
  const Film pilot = pilot_of(9, 7, 16, [](int, int, std::uint64_t) { return 3.0; });
  const SampleShares shares(pilot);
  for (const int step : {0, 40, 150})
    for (std::size_t i = 1; i < 63; ++i) EXPECT_EQ(shares.samples(i, step), shares.samples(0, step));
  EXPECT_EQ(shares.samples(0, 0), 16u);
  EXPECT_EQ(shares.expected_relmse(0), 0.0);
  EXPECT_EQ(shares.step_for(0.0, 5, 1e9), 5);
}

// Samples are proportional to the root of the variance, within the factor sqrt(2) of rounding to powers of two.
TEST(SampleShares, SamplesFollowTheRootOfTheVariance) {
  // The left half errs a little, the right half sixteen times as much in variance.
  const Film pilot = pilot_of(64, 64, 256, [](int x, int, std::uint64_t random) {
    return 1.0 + (x < 32 ? 0.1 : 0.4) * (unit_number(random) - 0.5);
  });
  const SampleShares shares(pilot);
  double left = 0.0, right = 0.0;
  int steps = 0;
  for (int step = 120; step < 120 + 16; ++step) {
    ++steps;
    for (std::size_t y = 0; y < 64; ++y) {
      left += std::log2(shares.samples(y * 64 + 10, step)) / 64;
      right += std::log2(shares.samples(y * 64 + 50, step)) / 64;
    }
  }
  EXPECT_NEAR((right - left) / steps, 2.0, 0.1) << "a factor of 4";
}

TEST(SampleShares, TotalsAndExpectationsAreThoseOfThePixels) {
  const Film pilot = pilot_of(20, 10, 16, rare);
  const SampleShares shares(pilot);
  for (const int step : {0, 77, 130, 200}) {
    double total = 0.0;
    for (std::size_t i = 0; i < 200; ++i) total += shares.samples(i, step);
    EXPECT_EQ(total, shares.total(step));
    EXPECT_LE(shares.total(step), shares.total(step + 1));
    EXPECT_GE(shares.expected_relmse(step), shares.expected_relmse(step + 1));
  }
  const double goal = shares.expected_relmse(0) / 50.0;
  const int step = shares.step_for(goal, 0, 1e12);
  EXPECT_LE(shares.expected_relmse(step), goal);
  EXPECT_GT(shares.expected_relmse(step - 1), goal);
  const int bounded = shares.step_for(0.0, 0, 10000.0);
  EXPECT_LE(shares.total(bounded), 10000.0);
  EXPECT_GT(shares.total(bounded + 1), 10000.0);
}

// What makes the picture unbiased: a pixel's own samples do not decide how many it gets.
TEST(SampleShares, APixelHasNoInfluenceOnItsOwnShare) {
  const auto spike = [](int x, int y, std::uint64_t random) {
    return unit_number(random) +
           (x == 5 && y == 5 ? (unit_number(hash_word(random)) < 0.25 ? 20.0 : 0.0) : 0.0);
  };
  const Film plain = pilot_of(11, 11, 64, [](int, int, std::uint64_t random) { return unit_number(random); });
  const SampleShares without(plain), with(pilot_of(11, 11, 64, spike));
  // All shares are relative to the mean, which the spike raises: compare with a pixel that is far from it.
  double neighbour = 0.0, far = 0.0;
  for (int step = 0; step < 220; ++step) {
    EXPECT_LE(with.samples(5 * 11 + 5, step), without.samples(5 * 11 + 5, step));
    neighbour += with.samples(5 * 11 + 6, step);
    far += with.samples(0, step);
  }
  EXPECT_GT(neighbour, far);
}

// A picture whose pixels are 1 on average by rare bright samples: its mean over many renders, by a z-test of
// each column at a joint level of 1e-3. Rendered to a number of samples, so that only the division of the
// samples can bias it.
TEST(SamplePlan, RareBrightSamplesAreNotLost) {
  constexpr int size = 12, runs = 1000;
  std::vector<test::Estimate> columns(size);
  double most = 0.0, fewest = 1e9;
  for (std::uint32_t run = 0; run < runs; ++run) {
    Film film(size, size);
    EXPECT_EQ(render(film, {40, 0.0, 1e-9}, run, rare), "samples");
    for (int x = 0; x < size; ++x) {
      double mean = 0.0;
      for (int y = 0; y < size; ++y) {
        mean += film.pixel(x, y).mean().x / size;
        most = std::max(most, static_cast<double>(film.pixel(x, y).samples));
        fewest = std::min(fewest, static_cast<double>(film.pixel(x, y).samples));
      }
      columns[static_cast<std::size_t>(x)].add(mean);
    }
  }
  EXPECT_GE(most / fewest, 4.0) << "the samples must have been divided unequally for this to be a test";
  for (const test::Estimate& column : columns)
    EXPECT_GT(test::two_sided_p((column.mean() - 1.0) / column.standard_error()), test::sidak(1e-3, size))
        << column.mean() << " +- " << column.standard_error();
}

TEST(SamplePlan, ReachesTheNoiseItIsAskedForWithFewerSamples) {
  Film film(48, 24);
  const auto half_black = [](int x, int, std::uint64_t random) {
    return x < 24 ? 0.0 : 0.5 + unit_number(random);
  };
  EXPECT_EQ(render(film, {0, 0.0, 0.02}, 1, half_black), "noise");
  EXPECT_LE(film.relative_error(), 0.02);
  // Uniform sampling needs v / (2 n) = 0.02^2 with v = 1/12 / 1.01.
  const double uniform = 1.0 / 12.0 / 1.01 / 2.0 / (0.02 * 0.02) * 48.0 * 24.0;
  EXPECT_LT(static_cast<double>(film.samples()), 0.75 * uniform);
  EXPECT_LT(film.pixel(5, 5).samples, film.pixel(40, 5).samples);
}

// Rare bright samples again, to a goal of noise: the error at the end is below the goal, not only its estimate.
TEST(SamplePlan, TheErrorOfRareBrightSamplesIsBelowTheGoal) {
  constexpr double bright = 60.0, chance = 3e-3, truth = 0.5 + chance * bright, goal = 0.3;
  const auto value = [&](int, int, std::uint64_t random) {
    return 0.5 + (unit_number(random) < chance ? bright : 0.0);
  };
  test::Estimate relmse;
  for (std::uint32_t run = 0; run < 10; ++run) {
    Film film(48, 24);
    EXPECT_EQ(render(film, {0, 0.0, goal}, run, value), "noise");
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 48; ++x) {
        const double d = film.pixel(x, y).mean().x - truth;
        relmse.add(d * d / (truth * truth + 0.01));
      }
  }
  EXPECT_LT(std::sqrt(relmse.mean()), goal);
  EXPECT_GT(std::sqrt(relmse.mean()), 0.4 * goal) << "more samples than needed";
}

TEST(SamplePlan, TheLimitOfSamplesIsKept) {
  for (const int limit : {1, 4, 16, 50, 100}) {
    Film film(16, 8);
    EXPECT_EQ(render(film, {limit, 0.0, 1e-9}, 1, rare), "samples");
    EXPECT_LE(film.samples(), static_cast<unsigned>(limit) * 16u * 8u);
    EXPECT_GT(film.samples(), static_cast<unsigned>(limit) * 16u * 8u / 2u);
    Film uniform(16, 8);
    EXPECT_EQ(render(uniform, {limit, 0.0, 0.0}, 1, rare), "samples");
    EXPECT_EQ(uniform.samples(), static_cast<unsigned>(limit) * 16u * 8u);
  }
}

// Of many pixels, four samples each tell how noisy they are.
TEST(SamplePlan, ALargePictureMayEndAfterFewSamples) {
  Film large(512, 512), small(64, 64);
  const auto even = [](int, int, std::uint64_t random) { return 2.0 * unit_number(random); };
  for (Film* film : {&large, &small}) EXPECT_EQ(render(*film, {0, 0.0, 0.5}, 1, even), "noise");
  EXPECT_EQ(large.samples(), 4u * 512 * 512);
  EXPECT_LE(large.relative_error(), 0.5);
  EXPECT_EQ(small.samples(), 16u * 64 * 64);
}

TEST(SamplePlan, OnePixelAndNoScatterEnd) {
  Film one(1, 1), calm(5, 5);
  EXPECT_EQ(render(one, {0, 0.0, 0.05}, 1, rare), "noise");
  EXPECT_EQ(render(calm, {0, 0.0, 0.05}, 1, [](int, int, std::uint64_t) { return 2.0; }), "noise");
  EXPECT_EQ(calm.samples(), 25u * 16u);
}

}  // namespace
}  // namespace twopass
