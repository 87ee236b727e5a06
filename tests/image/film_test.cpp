#include "render/image/film.h"

#include <random>

#include "render/core/parallel.h"
#include "tests/image/files.h"

namespace twopass {
namespace {

PixelBatch batch_of(std::initializer_list<float> greys) {
  PixelBatch batch;
  for (const float grey : greys) batch.add({grey, 2.0f * grey, 0.0f});
  return batch;
}

TEST(Film, ResolvesToTheMean) {
  Film film(2, 1);
  film.add_pixel(0, 0, batch_of({1.0f, 3.0f}));
  film.add_pixel(0, 0, batch_of({5.0f}));
  const Image image = film.resolve();
  EXPECT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B", "A"}));
  EXPECT_FLOAT_EQ(image.at(0, 0, 0), 3.0f);
  EXPECT_FLOAT_EQ(image.at(0, 0, 1), 6.0f);
  EXPECT_FLOAT_EQ(image.at(0, 0, 3), 1.0f);
  for (int c = 0; c < 4; ++c) EXPECT_EQ(image.at(1, 0, c), 0.0f) << "an empty pixel is black and transparent";
  EXPECT_EQ(film.samples(), 3u);
}

TEST(Film, WeightsAndAlpha) {
  Film film(1, 1);
  PixelBatch batch;
  batch.add({1.0f, 1.0f, 1.0f}, 1.0f, 1.5f);
  batch.add({5.0f, 5.0f, 5.0f}, 0.0f, 0.5f);
  film.add_pixel(0, 0, batch);
  EXPECT_FLOAT_EQ(film.resolve().at(0, 0, 0), 2.0f);
  EXPECT_FLOAT_EQ(film.resolve().at(0, 0, 3), 0.75f);
}

TEST(Film, SamplesThatAreNotFiniteCountAsBlack) {
  PixelBatch batch;
  EXPECT_TRUE(batch.add({4.0f, 4.0f, 4.0f}));
  EXPECT_FALSE(batch.add({NAN, 1.0f, 1.0f}));
  EXPECT_FALSE(batch.add({1.0f, INFINITY, 1.0f}));
  EXPECT_FALSE(batch.add({1.0f, 1.0f, 1.0f}, NAN));
  Film film(1, 1);
  film.add_pixel(0, 0, batch);
  EXPECT_FLOAT_EQ(film.resolve().at(0, 0, 0), 1.0f);
  EXPECT_FLOAT_EQ(film.resolve().at(0, 0, 3), 0.25f);
  EXPECT_EQ(film.samples(), 4u);
}

TEST(Film, ErrorOfTwoBatchesByHand) {
  Film film(1, 1);
  EXPECT_EQ(film.relative_error(), std::numeric_limits<double>::infinity());
  film.add_pixel(0, 0, batch_of({1.0f, 1.0f}));
  EXPECT_EQ(film.relative_error(), std::numeric_limits<double>::infinity());
  film.add_pixel(0, 0, batch_of({3.0f, 3.0f}));
  // Red: means 1 and 3 of two samples each: spread 2+2 = 4, variance of the mean 4 / (1 * 4) = 1, mean 2.
  // Green is twice that; blue is zero with variance zero.
  EXPECT_DOUBLE_EQ(film.relative_error(), std::sqrt((1.0 / 4.01 + 4.0 / 16.01 + 0.0) / 3.0));
}

TEST(Film, BatchesOfUnequalSizeCountBySamples) {
  Film film(1, 1);
  film.add_pixel(0, 0, batch_of({0.0f}));
  film.add_pixel(0, 0, batch_of({4.0f, 4.0f, 4.0f}));
  // Mean 3, spread 1 * 9 + 3 * 1 = 12, variance of the mean 12 / (1 * 4) = 3.
  EXPECT_DOUBLE_EQ(film.pixel(0, 0).spread.x, 12.0);
  EXPECT_DOUBLE_EQ(film.relative_error(), std::sqrt((3.0 / 9.01 + 12.0 / 36.01) / 3.0));
}

// The estimate against the truth: exponential samples of mean m have the variance m^2, so that the relMSE of n
// samples is m^2 / (n (m^2 + 0.01)). 4096 pixels x 3 channels x 15 degrees of freedom: relative standard error
// of the estimated relMSE below 2 %; the mean in the denominator adds a bias of order 3/n.
TEST(Film, ErrorEstimateIsRight) {
  constexpr int size = 64, passes = 16, per_pass = 16;
  constexpr float mean = 0.5f;
  Film film(size, size);
  std::mt19937 generator(3);
  std::exponential_distribution<float> sample(1.0f / mean);
  for (int pass = 0; pass < passes; ++pass)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        PixelBatch batch;
        for (int i = 0; i < per_pass; ++i) batch.add({sample(generator), sample(generator), sample(generator)});
        film.add_pixel(x, y, batch);
      }
  const double n = passes * per_pass;
  const double expected = std::sqrt(mean * mean / (mean * mean + 0.01) / n);
  EXPECT_NEAR(film.relative_error() / expected, 1.0, 0.03);
}

// Rare bright samples: one in a thousand is 400 times the rest. The few pixels that have met one must not hide
// it by their own bright mean: then this estimate would be a twentieth of the truth.
TEST(Film, ErrorEstimateOfRareBrightSamples) {
  constexpr int size = 64;
  constexpr float bright = 200.0f, chance = 1e-3f;
  Film film(size, size);
  std::mt19937 generator(7);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  for (int pass = 0; pass < 2; ++pass)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        PixelBatch batch;
        for (int i = 0; i < 8; ++i) batch.add(C3f(uniform(generator) < chance ? bright : 0.5f));
        film.add_pixel(x, y, batch);
      }
  const double mean = 0.5 + 199.5 * 1e-3, variance = 199.5 * 199.5 * 1e-3 * (1.0 - 1e-3);
  const double expected = variance / 16.0 / (mean * mean + 0.01);
  EXPECT_GT(film.noise().relmse / expected, 0.7);
  EXPECT_LT(film.noise().relmse / expected, 2.0);
  EXPECT_GT(film.noise().standard_error / film.noise().relmse, 0.05) << "about 65 such samples in all";
  EXPECT_LT(film.noise().standard_error / film.noise().relmse, 0.3);
}

// A bright column in black counts by its own radiance, less two standard errors: the surroundings do not make
// its error larger than it is. A single bright pixel whose two batches disagree counts by the surroundings.
TEST(Film, ErrorEstimateBelievesWhatIsCertain) {
  Film film(9, 9);
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 9; ++x)
      for (const float change : {-0.1f, 0.1f}) {
        PixelBatch batch;
        batch.add(C3f(x == 4 ? 1.0f + change : x == 8 && y == 8 ? 1.0f + 10.0f * change : 0.0f));
        film.add_pixel(x, y, batch);
      }
  // Variance of a sample .02, of the mean .01.
  const std::vector<Around> surroundings = film.surroundings();
  const auto around = [&](int x, int y) { return surroundings[static_cast<std::size_t>(9 * y + x)]; };
  const auto relative_variance = [&](int x, int y) { return film.pixel(x, y).noise().relative(around(x, y)); };
  EXPECT_NEAR(relative_variance(4, 4), 0.02 / (0.8 * 0.8 + 0.01), 1e-6);
  EXPECT_EQ(relative_variance(3, 4), 0.0);
  EXPECT_NEAR(relative_variance(8, 8), 2.0 / 0.01, 1e-3);
  EXPECT_NEAR(around(3, 4).sum.x, 5.0, 1e-6);
  EXPECT_EQ(around(3, 4).count, 24);
  EXPECT_EQ(Film(1, 1).surroundings()[0].count, 0);
}

TEST(Film, MergingFilmsIsRenderingOn) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<float> sample(0.0f, 2.0f);
  Film whole(1, 1), first(1, 1), second(1, 1);
  for (int pass = 0; pass < 10; ++pass) {
    const PixelBatch batch = batch_of({sample(generator), sample(generator)});
    whole.add_pixel(0, 0, batch);
    (pass < 4 ? first : second).add_pixel(0, 0, batch);
  }
  first.merge(second);
  EXPECT_EQ(first.samples(), whole.samples());
  EXPECT_NEAR(first.relative_error(), whole.relative_error(), 1e-12);
  EXPECT_NEAR(first.pixel(0, 0).sum.x, whole.pixel(0, 0).sum.x, 1e-12);
  EXPECT_EQ(first.pixel(0, 0).batches, 10u);
  Film other(2, 1);
  EXPECT_THROW(first.merge(other), Error);
}

TEST(Film, ThreadsOwnPixelsAndChangeNothing) {
  const auto render = [](std::size_t grain) {
    Film film(32, 32);
    for (int pass = 0; pass < 3; ++pass)
      parallel_for(32, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y)
          for (int x = 0; x < 32; ++x)
            film.add_pixel(x, static_cast<int>(y),
                           batch_of({static_cast<float>(y) + 0.1f * static_cast<float>(x + pass)}));
      });
    return film.resolve().pixels;
  };
  EXPECT_EQ(render(32), render(1));
}

TEST(Film, NeverNaN) {
  Film film(1, 1);
  const float huge = std::numeric_limits<float>::max();
  film.add_pixel(0, 0, batch_of({huge, -huge}));
  film.add_pixel(0, 0, batch_of({-huge}));
  EXPECT_FALSE(std::isnan(film.relative_error()));
  Film negative(1, 1);
  PixelBatch lobe;
  lobe.add({1.0f, 1.0f, 1.0f}, 1.0f, -0.5f);
  negative.add_pixel(0, 0, lobe);
  negative.add_pixel(0, 0, lobe);
  EXPECT_FLOAT_EQ(negative.resolve().at(0, 0, 0), 1.0f) << "flat, whatever the weights";
  EXPECT_FALSE(std::isnan(negative.relative_error()));
}

// Weights of kernels with negative lobes: flat areas stay flat and free of noise after any number of samples.
TEST(Film, FlatAreasHaveNoNoiseFromWeights) {
  std::mt19937 generator(9);
  std::bernoulli_distribution negative(0.2);
  for (int samples = 1; samples < 20; ++samples) {
    Film film(1, 1);
    for (int pass = 0; pass < 3; ++pass) {
      PixelBatch batch;
      for (int i = 0; i < samples; ++i) batch.add({2.0f, 3.0f, 4.0f}, 1.0f, negative(generator) ? -1.5f : 1.5f);
      film.add_pixel(0, 0, batch);
    }
    EXPECT_NEAR(film.resolve().at(0, 0, 0), 2.0f, 1e-6f);
    EXPECT_NEAR(film.resolve().at(0, 0, 3), 1.0f, 1e-6f);
    EXPECT_NEAR(film.relative_error(), 0.0, 1e-6);
  }
}

// Against the truth where the picture is not flat: positions x uniform in [-1, 1], f = x^2, weights 1.5 for |x|
// < 0.8 and -1 beyond, which are 1 on average.
TEST(Film, SignedWeightsConvergeToTheFilteredValue) {
  constexpr int pixels = 64, passes = 16, per_pass = 16;
  Film film(pixels, pixels);
  std::mt19937 generator(4);
  std::uniform_real_distribution<float> position(-1.0f, 1.0f);
  for (int pass = 0; pass < passes; ++pass)
    for (int y = 0; y < pixels; ++y)
      for (int x = 0; x < pixels; ++x) {
        PixelBatch batch;
        for (int i = 0; i < per_pass; ++i) {
          const float at = position(generator), f = at * at;
          batch.add({f, f, f}, 1.0f, std::abs(at) < 0.8f ? 1.5f : -1.0f);
        }
        film.add_pixel(x, y, batch);
      }
  // Integral over [0, 1]: 1.5 * 0.8^3 / 3 - (1 - 0.8^3) / 3.
  const double expected = (2.5 * 0.512 - 1.0) / 3.0, plain = 1.0 / 3.0, n = passes * per_pass;
  const Image image = film.resolve();
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < image.pixel_count(); ++i) {
    sum += image.pixels[4 * i];
    squares += static_cast<double>(image.pixels[4 * i]) * image.pixels[4 * i];
  }
  const double count = pixels * pixels, mean = sum / count, variance = squares / count - mean * mean;
  // The bias that film.h states, within 4 standard errors.
  EXPECT_NEAR(mean, expected + (plain - expected) / n, 4.0 * std::sqrt(variance / count));
  // Estimated from batches against seen between pixels. (S9) divides by b^2 + 0.01, b the smaller of the
  // pixel's mean (standard deviation s) and that of the 24 around it: E b = mu - s sqrt(25/24) / sqrt(2 pi), E
  // (b - mu)^2 = 25/48 s^2. With mu = 0.0933 and s = 0.0179 (the integral of w^2 (f - 1/3)^2, less (mu -
  // 1/3)^2, over n) the second-order expansion of (mu^2 + 0.01) / (b^2 + 0.01) has the mean 1.080. 4096 pixels
  // give both variances to 2.3 % (1 sigma).
  const double estimated = film.relative_error() * film.relative_error() * (expected * expected + 0.01);
  EXPECT_NEAR(estimated / variance, 1.08, 4 * 0.023);
}

TEST(Film, ImpossibleSizesAreErrors) {
  EXPECT_THROW(Film(0, 5), Error);
  EXPECT_THROW(Film(5, -1), Error);
  EXPECT_THROW(Film(1 << 20, 1 << 20), Error);
}

}  // namespace
}  // namespace twopass
