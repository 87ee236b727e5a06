#include "render/image/compare.h"

#include <set>

#include "render/image/flip.h"
#include "render/image/srgb.h"
#include "tests/image/files.h"

namespace twopass {
namespace {

Image uniform(int width, int height, const C3f& color) {
  Image image(width, height, {"R", "G", "B"});
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = color[static_cast<int>(i % 3)];
  return image;
}

TEST(Compare, ByHand) {
  const Comparison c = compare(uniform(4, 3, {1.0f, 0.5f, 0.0f}), uniform(4, 3, {0.5f, 0.5f, 0.25f}));
  EXPECT_DOUBLE_EQ(c.energy_ratio.x, 2.0);
  EXPECT_DOUBLE_EQ(c.energy_ratio.y, 1.0);
  EXPECT_DOUBLE_EQ(c.energy_ratio.z, 0.0);
  EXPECT_NEAR(c.mse, (0.25 + 0.0625) / 3.0, 1e-12);
  EXPECT_NEAR(c.relmse, (0.25 / 0.26 + 0.0625 / 0.0725) / 3.0, 1e-12);
  EXPECT_NEAR(c.smape, (2.0 * 0.5 / 1.52 + 2.0 * 0.25 / 0.27) / 3.0, 1e-12);
  const double r = 1.0 - srgb_encode(0.5f), b = srgb_encode(0.25f);
  EXPECT_NEAR(c.psnr, -10.0 * std::log10((r * r + b * b) / 3.0), 1e-6);
  EXPECT_EQ(c.non_finite, 0u);
  EXPECT_EQ(c.width, 4);
  EXPECT_EQ(c.height, 3);
}

TEST(Compare, EqualPictures) {
  const Image image = random_image(20, 20, {"R", "G", "B", "A", "Z"}, 0.0f, 9.0f);
  const Comparison c = compare(image, image);
  EXPECT_EQ(c.energy_ratio, C3d(1.0, 1.0, 1.0));
  EXPECT_EQ(c.mse, 0.0);
  EXPECT_EQ(c.relmse, 0.0);
  EXPECT_EQ(c.smape, 0.0);
  EXPECT_EQ(c.flip, 0.0);
  EXPECT_EQ(c.psnr, std::numeric_limits<double>::infinity());
}

TEST(Compare, TrimmingTakesTheWorstThousandthOfThePixels) {
  const Image reference = uniform(100, 20, {1.0f, 1.0f, 1.0f});
  Image test = uniform(100, 20, {1.1f, 1.1f, 1.1f});
  test.at(3, 4, 0) = 1e4f;  // two fireflies in 2000 pixels
  test.at(9, 9, 2) = 1e4f;
  const Comparison c = compare(test, reference);
  EXPECT_GT(c.relmse, 1e4);
  EXPECT_NEAR(c.relmse_trimmed, 0.01 / 1.01, 1e-7);
  test.at(50, 5, 1) = 1e4f;
  EXPECT_GT(compare(test, reference).relmse_trimmed, 1e3) << "the third is one too many";
}

TEST(Compare, PixelsThatAreNotFiniteAreCountedAndLeftOut) {
  Image test = uniform(4, 1, {2.0f, 2.0f, 2.0f}), reference = uniform(4, 1, {1.0f, 1.0f, 1.0f});
  test.at(0, 0, 1) = NAN;
  reference.at(1, 0, 0) = INFINITY;
  const Comparison c = compare(test, reference);
  EXPECT_EQ(c.non_finite, 2u);
  EXPECT_DOUBLE_EQ(c.mse, 1.0);
  EXPECT_EQ(c.energy_ratio, C3d(2.0, 2.0, 2.0));
  for (const Measure& m : measures()) EXPECT_FALSE(std::isnan(m.value(c))) << m.name;
}

TEST(Compare, NothingLeftIsInfinitelyWrong) {
  const Image bad = uniform(2, 2, {NAN, NAN, NAN});
  const Comparison c = compare(bad, bad);
  EXPECT_EQ(c.non_finite, 4u);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double v : {c.mse, c.relmse, c.relmse_trimmed, c.smape, c.flip, -c.psnr, c.energy_ratio.x})
    EXPECT_EQ(v, infinity);
}

TEST(Compare, EnergyOfBlackReferences) {
  const Image black = uniform(2, 2, {0.0f, 0.0f, 0.0f});
  EXPECT_EQ(compare(black, black).energy_ratio, C3d(1.0, 1.0, 1.0));
  EXPECT_EQ(compare(uniform(2, 2, {0.1f, 0.0f, 0.0f}), black).energy_ratio.x,
            std::numeric_limits<double>::infinity());
}

TEST(Compare, SizesMustAgree) {
  const std::string message = error_of([] { (void)compare(Image(4, 4, {"Y"}), Image(4, 5, {"Y"})); });
  EXPECT_TRUE(contains(message, "4x4") && contains(message, "4x5")) << message;
  EXPECT_THROW((void)compare(Image(4, 4, {"Z"}), Image(4, 4, {"Y"})), Error);
}

TEST(Compare, GreyAndColorCanBeCompared) {
  Image grey(2, 2, {"Y"});
  grey.pixels.assign(4, 0.5f);
  EXPECT_EQ(compare(grey, uniform(2, 2, {0.5f, 0.5f, 0.5f})).mse, 0.0);
}

TEST(Compare, FlipIsTheMeanOfHdrFlip) {
  const Image t = random_image(30, 30, {"R", "G", "B"}, 0.0f, 4.0f, 1);
  const Image r = random_image(30, 30, {"R", "G", "B"}, 0.0f, 4.0f, 2);
  EXPECT_EQ(compare(t, r).flip, hdr_flip(rgb_pixels(t), rgb_pixels(r), 30, 30).mean);
}

// A picture of ones with a constant error and noise of its own in each pixel and channel.
LayerPair biased_and_noisy(float bias, float noise) {
  const Image scatter = random_image(96, 64, {"R", "G", "B"}, -1.0f, 1.0f, 5);
  LayerPair pair{.name = "", .width = 96, .height = 64};
  for (const C3f& s : rgb_pixels(scatter)) {
    pair.reference.emplace_back(1.0f, 1.0f, 1.0f);
    pair.test.push_back(C3f(1.0f + bias) + s * noise);
  }
  return pair;
}

TEST(Compare, BlocksTellBiasFromNoise) {
  // A uniform number in [-1, 1] has the variance 1/3.
  constexpr double noise2 = 0.2 * 0.2 / 3.0 / 1.01;
  for (const double bias : {0.0, 0.02, -0.1}) {
    const Comparison c = compare(biased_and_noisy(static_cast<float>(bias), 0.2f));
    const double truth = bias * bias / 1.01;
    EXPECT_GT(c.bias2_error, 0.0);
    EXPECT_NEAR(c.bias2, truth, 4.0 * c.bias2_error) << bias;
    EXPECT_NEAR(c.variance, noise2, 0.03 * noise2 + 4.0 * c.bias2_error) << bias;
    EXPECT_DOUBLE_EQ(c.bias2 + c.variance, c.relmse);
    EXPECT_NEAR(c.energy_ratio.x, 1.0 + bias, 2.0 * c.energy_ci95.x);
    EXPECT_NEAR(c.energy_ci95.x, 1.96 * std::sqrt(0.04 / 3.0 / (96 * 64)), 1e-4);
  }
  // Without noise all of it is bias, to rounding; and the standard error is not made up.
  const Comparison clean = compare(biased_and_noisy(0.1f, 0.0f));
  EXPECT_NEAR(clean.bias2, clean.relmse, 1e-9);
  EXPECT_NEAR(clean.bias2_error, 0.0, 1e-9);
}

TEST(Compare, StandardErrorOfTheBiasIsWhatItScattersBy) {
  double sum2 = 0.0, expected = 0.0;
  constexpr int runs = 40;
  for (int run = 0; run < runs; ++run) {
    LayerPair pair{.name = "", .width = 64, .height = 64};
    for (const C3f& s : rgb_pixels(random_image(64, 64, {"R", "G", "B"}, 0.5f, 1.5f, 100u + run))) {
      pair.reference.emplace_back(1.0f, 1.0f, 1.0f);
      pair.test.push_back(s);
    }
    const Comparison c = compare(pair);
    sum2 += c.bias2 * c.bias2 / runs;  // the truth is zero
    expected += c.bias2_error * c.bias2_error / runs;
  }
  // A variance of 40 runs is known to 22 %.
  EXPECT_NEAR(std::sqrt(sum2 / expected), 1.0, 0.4);
}

TEST(Compare, LayersInCommonWithTheirVariance) {
  const Image test =
      random_image(12, 9, {"R", "G", "B", "A", "variance.R", "variance.G", "variance.B", "Z"}, 0.0f, 1.0f, 1);
  const Image reference =
      random_image(12, 9, {"R", "G", "B", "Z", "albedo.R", "albedo.G", "albedo.B"}, 0.0f, 1.0f, 2);
  const std::vector<LayerPair> pairs = common_layers(test, reference);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].name, "");
  EXPECT_EQ(pairs[1].name, "Z");
  EXPECT_EQ(pairs[1].kind, LayerKind::scalar);
  EXPECT_FLOAT_EQ(pairs[0].variance[5].y, test.pixels[5 * 8 + 5]);
  const Comparison c = compare(pairs[0]);
  ASSERT_TRUE(c.known_variance);
  double sum = 0.0;
  for (std::size_t i = 0; i < 12 * 9; ++i)
    for (int k = 0; k < 3; ++k) {
      const double r = pairs[0].reference[i][k];
      sum += pairs[0].variance[i][k] / (r * r + 0.01);
    }
  EXPECT_NEAR(*c.known_variance, sum / (3.0 * 12 * 9), 1e-9);
  EXPECT_FALSE(compare(pairs[1]).known_variance);
  EXPECT_EQ(compare(pairs[1]).flip, std::numeric_limits<double>::infinity()) << "nobody sees depths";
  EXPECT_THROW((void)common_layers(Image(4, 4, {"Z"}), Image(4, 4, {"Y"})), Error);
}

TEST(Compare, EveryMeasureHasANameAFormulaAndItsValue) {
  Comparison c;
  c.energy_ratio = C3d(1.0, 3.0, 2.0);
  c.bias2 = 4.0;
  c.variance = 5.0;
  c.mse = 10.0;
  c.relmse = 11.0;
  c.relmse_trimmed = 12.0;
  c.smape = 13.0;
  c.psnr = 14.0;
  c.flip = 15.0;
  c.non_finite = 16;
  const std::vector<double> values{3.0, 4.0, 5.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0, 16.0};
  ASSERT_EQ(measures().size(), values.size());
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(measures()[i].value(c), values[i]);
    EXPECT_FALSE(measures()[i].formula.empty());
    names.insert(measures()[i].name);
  }
  EXPECT_EQ(names.size(), values.size());
  EXPECT_EQ(measure_of_name("relmse", "--max").value(c), 11.0);
  EXPECT_TRUE(contains(error_of([] { (void)measure_of_name("ssim", "--max"); }), "smape"));
}

}  // namespace
}  // namespace twopass
