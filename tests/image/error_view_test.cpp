#include "render/image/error_view.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

namespace twopass {
namespace {

// Ones, and in the test picture 1 + error at one pixel.
LayerPair one_error(int width, int height, int x, int y, float error) {
  LayerPair pair{.name = "", .width = width, .height = height};
  pair.reference.assign(static_cast<std::size_t>(width * height), C3f(1.0f));
  pair.test = pair.reference;
  pair.test[static_cast<std::size_t>(y * width + x)] += C3f(error);
  return pair;
}

TEST(ErrorView, Maps) {
  LayerPair pair = one_error(3, 2, 1, 1, -0.5f);
  pair.test[0] = C3f(NAN, 1.0f, 1.0f);
  pair.test[5] = C3f(1.3f, 0.7f, 1.0f);
  const ErrorMaps maps = error_maps(pair);
  EXPECT_EQ(maps.difference[0], 0.0f);
  EXPECT_FLOAT_EQ(maps.difference[4], -0.5f);
  EXPECT_FLOAT_EQ(maps.magnitude[4], 0.5f);
  EXPECT_FLOAT_EQ(maps.relative[4], 0.5f / std::sqrt(1.01f));
  EXPECT_NEAR(maps.difference[5], 0.0f, 1e-7) << "channels cancel";
  EXPECT_NEAR(maps.magnitude[5], 0.2f, 1e-7);
}

TEST(ErrorView, Quantiles) {
  std::vector<float> values(101);
  std::iota(values.begin(), values.end(), -100.0f);
  values.push_back(NAN);
  EXPECT_EQ(quantile_of_magnitude(values, 0.99), 99.0f);
  EXPECT_EQ(quantile_of_magnitude(values, 1.0), 100.0f);
  EXPECT_EQ(quantile_of_magnitude({}, 0.5), 0.0f);
}

TEST(ErrorView, WorstTilesAreTheWorst) {
  LayerPair pair = one_error(20, 10, 17, 9, 0.5f);
  pair.test[0] += C3f(-0.1f);
  const std::vector<ErrorTile> tiles = worst_tiles(pair, 8, 5);
  ASSERT_EQ(tiles.size(), 2u) << "those without an error are none";
  EXPECT_EQ(tiles[0].x, 16);
  EXPECT_EQ(tiles[0].y, 8);
  EXPECT_EQ(tiles[0].width, 4) << "at the border";
  EXPECT_EQ(tiles[0].height, 2);
  EXPECT_NEAR(tiles[0].relmse, 0.25 / 1.01 / 8, 1e-9);
  EXPECT_NEAR(tiles[0].bias, 0.5 / std::sqrt(1.01) / 8, 1e-9);
  EXPECT_NEAR(tiles[0].share, 25.0 / 26.0, 1e-6);
  EXPECT_LT(tiles[1].bias, 0.0);
  EXPECT_EQ(worst_tiles(pair, 8, 1).size(), 1u);
}

TEST(ErrorView, HistogramCountsEveryPixelOnce) {
  const std::vector<float> relative{0.0f, 1e-6f, 1.1e-5f, 0.05f, 0.05f, 99.0f, 1e3f, INFINITY};
  const ErrorHistogram histogram = error_histogram(relative);
  EXPECT_EQ(histogram.below, 2u);
  EXPECT_EQ(histogram.above, 2u);
  EXPECT_EQ(histogram.bins.front(), 1u);
  EXPECT_EQ(histogram.bins.back(), 1u);
  EXPECT_EQ(histogram.bins[14], 2u) << "0.05 = 10^-1.301: between -1.5 and -1.25";
}

TEST(ErrorView, ColorsRunFromEndToEnd) {
  const std::vector<float> values{-2.0f, -1.0f, 0.0f, 1.0f, 9.0f};
  const Image image = colored(values, 5, 1, -1.0f, 1.0f, diverging_colors());
  EXPECT_EQ(image.rgb(0, 0), image.rgb(1, 0)) << "beyond the end";
  EXPECT_EQ(image.rgb(3, 0), image.rgb(4, 0));
  EXPECT_GT(image.rgb(1, 0).z, image.rgb(1, 0).x) << "blue below";
  EXPECT_GT(image.rgb(3, 0).x, image.rgb(3, 0).z) << "red above";
  EXPECT_GT(image.rgb(2, 0).y, 0.95f) << "white between";
  float last = -1.0f;
  for (const auto& color : sequential_colors()) {
    const float y = luminance(C3f(color[0], color[1], color[2]));
    EXPECT_GE(y, last) << "more is lighter";
    last = y;
  }
}

}  // namespace
}  // namespace twopass
