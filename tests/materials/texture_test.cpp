#include "materials/texture.h"

#include <gtest/gtest.h>

namespace twopass {
namespace {

// Texels 0 1 2 / 3 4 5, grey.
Bitmap bitmap(TextureFilter filter, TextureWrap wrap) {
  auto image = std::make_shared<Image>(3, 2, std::vector<std::string>{"R", "G", "B"});
  for (int i = 0; i < 6; ++i)
    for (int c = 0; c < 3; ++c) image->pixels[static_cast<std::size_t>(3 * i + c)] = static_cast<float>(i);
  return Bitmap{std::make_shared<TextureImage>(*image), filter, wrap, wrap};
}

TEST(Texture, ConstantsAreTheSameEverywhere) {
  EXPECT_EQ(color_at(C3f(0.1f, 0.2f, 0.3f), V2f(7, -3)), C3f(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(number_at(C3f(0.3f), V2f(0, 0)), 0.3f);
}

TEST(Texture, CheckerboardsAlternateByHalfUnits) {
  const Checkerboard board{C3f(1.0f), C3f(0.0f), {}};
  EXPECT_EQ(color_at(board, V2f(0.2f, 0.2f)), C3f(1.0f));
  EXPECT_EQ(color_at(board, V2f(0.7f, 0.2f)), C3f(0.0f));
  EXPECT_EQ(color_at(board, V2f(0.7f, 0.7f)), C3f(1.0f));
  EXPECT_EQ(color_at(board, V2f(-0.2f, 0.2f)), C3f(0.0f));
  EXPECT_EQ(number_at(board, V2f(0.2f, 0.2f)), 0.0f);  // exchanged, as in Mitsuba
  EXPECT_EQ(mean_color(board), C3f(0.5f));
}

TEST(Texture, NearestTexelsAreConstant) {
  const Bitmap b = bitmap(TextureFilter::nearest, TextureWrap::repeat);
  EXPECT_EQ(number_at(b, V2f(0.1f, 0.1f)), 0.0f);
  EXPECT_EQ(number_at(b, V2f(0.9f, 0.1f)), 2.0f);
  EXPECT_EQ(number_at(b, V2f(0.5f, 0.9f)), 4.0f);
  EXPECT_EQ(gradient_at(b, V2f(0.5f, 0.9f)), V2f(0, 0));
}

TEST(Texture, BilinearInterpolationIsExactBetweenCentres) {
  const Bitmap b = bitmap(TextureFilter::bilinear, TextureWrap::clamp);
  EXPECT_FLOAT_EQ(number_at(b, V2f(0.5f, 0.25f)), 1.0f);
  EXPECT_FLOAT_EQ(number_at(b, V2f(0.5f, 0.5f)), 2.5f);
  EXPECT_FLOAT_EQ(number_at(b, V2f(1.0f / 3, 0.25f)), 0.5f);
  // One unit of u holds three texels that rise by 1, one of v two that rise by 3.
  EXPECT_NEAR(gradient_at(b, V2f(0.4f, 0.4f)).x, 3.0f, 1e-5f);
  EXPECT_NEAR(gradient_at(b, V2f(0.4f, 0.4f)).y, 6.0f, 1e-5f);
}

TEST(Texture, WrapsAsAsked) {
  const auto at = [](TextureWrap wrap, float u) {
    return number_at(bitmap(TextureFilter::nearest, wrap), V2f(u, 0.1f));
  };
  const float past = 1.1f, before = -0.1f, far = 2.5f;
  EXPECT_EQ(at(TextureWrap::repeat, past), 0.0f);
  EXPECT_EQ(at(TextureWrap::mirror, past), 2.0f);
  EXPECT_EQ(at(TextureWrap::clamp, past), 2.0f);
  EXPECT_EQ(at(TextureWrap::repeat, before), 2.0f);
  EXPECT_EQ(at(TextureWrap::mirror, before), 0.0f);
  EXPECT_EQ(at(TextureWrap::clamp, before), 0.0f);
  EXPECT_EQ(at(TextureWrap::repeat, far), 1.0f);
  EXPECT_EQ(at(TextureWrap::mirror, far), 1.0f);
}

TEST(Texture, GradientFollowsTheTransform) {
  Bitmap b = bitmap(TextureFilter::bilinear, TextureWrap::repeat);
  b.to_uv = {0.5f, 0.2f, 0.1f, -0.3f, 0.7f, 0.05f};
  const V2f uv(0.6f, 0.7f);
  constexpr float h = 1e-3f;
  const V2f g = gradient_at(b, uv);
  EXPECT_NEAR(g.x, (number_at(b, uv + V2f(h, 0)) - number_at(b, uv - V2f(h, 0))) / (2 * h), 5e-2f);
  EXPECT_NEAR(g.y, (number_at(b, uv + V2f(0, h)) - number_at(b, uv - V2f(0, h))) / (2 * h), 5e-2f);
}

TEST(Texture, CoordinatesThatAreNoNumbersAreHarmless) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const TextureFilter filter : {TextureFilter::bilinear, TextureFilter::nearest})
    for (const float u : {nan, infinity_f, -infinity_f, 1e30f})
      EXPECT_TRUE(std::isfinite(number_at(bitmap(filter, TextureWrap::repeat), V2f(u, u))));
}

// The mean over the footprint by many points.
C3f brute_force(const Texture& texture, const TexturePoint& at) {
  constexpr int n = 400;
  C3d sum(0.0);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const V2f offset((static_cast<float>(i) + 0.5f) / n - 0.5f, (static_cast<float>(j) + 0.5f) / n - 0.5f);
      sum += C3d(color_at(texture, at.uv + V2f(offset.x * at.footprint.x, offset.y * at.footprint.y)));
    }
  return C3f(sum / static_cast<double>(n * n));
}

TEST(TextureFootprint, CheckerboardsAreIntegratedExactly) {
  const Checkerboard board{C3f(1.0f, 0.5f, 0.0f), C3f(0.0f, 0.25f, 1.0f), {2.0f, 0, 0.1f, 0, 3.0f, -0.2f}};
  for (const V2f& uv : {V2f(0.1f, 0.2f), V2f(0.27f, 0.31f), V2f(7.9f, -3.4f)})
    for (const V2f& footprint : {V2f(0.01f, 0.01f), V2f(0.2f, 0.05f), V2f(0.7f, 1.3f), V2f(30.0f, 40.0f)}) {
      const TexturePoint at(uv, footprint);
      const C3f filtered = color_at(board, at), mean = brute_force(board, at);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(filtered[c], mean[c], 8e-3f) << uv << footprint;
    }
  // Far away it is grey.
  EXPECT_NEAR(color_at(board, {V2f(0.3f, 0.4f), V2f(100.0f, 100.0f)}).x, 0.5f, 3e-3f);
}

Bitmap checker_bitmap(int size) {
  Image image(size, size, {"R", "G", "B"});
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>((x + y) % 2);
  return {std::make_shared<TextureImage>(image)};
}

TEST(TextureFootprint, NeverLooksAtTexelsLargerThanItself) {
  const Bitmap b = checker_bitmap(64);
  const V2f uv(0.5f / 64, 0.5f / 64);  // the centre of a black texel
  const auto at = [&](float u, float v) { return color_at(b, {uv, V2f(u / 64, v / 64)}).x; };
  EXPECT_EQ(at(0, 0), 0.0f);
  EXPECT_EQ(at(1.99f, 1.99f), 0.0f);
  EXPECT_EQ(at(1.99f, 50.0f), 0.0f);  // the narrow side decides
  EXPECT_EQ(at(50.0f, 1.99f), 0.0f);
  EXPECT_EQ(at(2.01f, 2.01f), 0.5f);
  EXPECT_EQ(at(1e6f, 1e6f), 0.5f);
  EXPECT_EQ(at(infinity_f, infinity_f), 0.5f);
  EXPECT_EQ(at(std::numeric_limits<float>::quiet_NaN(), 5.0f), 0.0f);
}

TEST(TextureFootprint, GradientsOfCoarseLevelsKeepTheirUnits) {
  Image ramp(64, 64, {"R", "G", "B"});
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c) ramp.at(x, y, c) = static_cast<float>(2 * x + 3 * y);
  const Bitmap b{std::make_shared<TextureImage>(ramp)};
  for (const float texels : {0.0f, 2.5f, 5.0f, 9.0f}) {
    const V2f slope = gradient_at(b, {V2f(0.5f, 0.5f), V2f(texels / 64, texels / 64)});
    EXPECT_NEAR(slope.x, 128.0f, 1e-2f) << texels;
    EXPECT_NEAR(slope.y, 192.0f, 1e-2f) << texels;
  }
}

TEST(Texture, ScalesLimitTheResult) {
  const TexelScale twice{
      .factor = C3f(2.0f, 1.0f, 0.5f), .offset = C3f(-0.5f), .lowest = 0.0f, .highest = 1.0f};
  EXPECT_EQ(std::get<C3f>(scaled(C3f(1.0f), twice)), C3f(1.0f, 0.5f, 0.0f));
  const Texture board = scaled(Checkerboard{C3f(0.5f), C3f(0.0f), {}}, twice);
  EXPECT_EQ(color_at(board, V2f(0.1f, 0.1f)), C3f(0.5f, 0.0f, 0.0f));
  const Bitmap b = bitmap(TextureFilter::nearest, TextureWrap::clamp);
  EXPECT_EQ(color_at(scaled(b, twice), V2f(0.5f, 0.1f)), C3f(1.0f, 0.5f, 0.0f));
  const Texture again = scaled(scaled(b, {.factor = C3f(2.0f)}), {.factor = C3f(3.0f), .offset = C3f(1.0f)});
  EXPECT_EQ(number_at(again, V2f(0.9f, 0.9f)), 31.0f);
}

TEST(Texture, EachAxisHasItsWrap) {
  Bitmap b = bitmap(TextureFilter::nearest, TextureWrap::repeat);
  b.wrap_v = TextureWrap::clamp;
  EXPECT_EQ(number_at(b, V2f(1.1f, 1.1f)), 3.0f);
}

TEST(Texture, UdimTilesLieInRowsUpwards) {
  // Each tile has one colour: its number.
  const auto tile = [](int number) {
    Image image(1, 1, {"R", "G", "B"});
    image.pixels = {static_cast<float>(number), static_cast<float>(number), static_cast<float>(number)};
    Bitmap b{std::make_shared<TextureImage>(image)};
    b.to_uv.c = -static_cast<float>((number - 1001) % 10);
    b.to_uv.f = static_cast<float>((number - 1001) / 10);
    return b;
  };
  Udim udim;
  udim.tiles.resize(12);
  for (const int number : {1001, 1002, 1012})
    udim.tiles[static_cast<std::size_t>(number - 1001)] = tile(number);
  const auto at = [&](float u, float v_upwards) { return number_at(udim, V2f(u, 1.0f - v_upwards)); };
  EXPECT_EQ(at(0.5f, 0.5f), 1001.0f);
  EXPECT_EQ(at(1.5f, 0.5f), 1002.0f);
  EXPECT_EQ(at(1.5f, 1.5f), 1012.0f);
  EXPECT_EQ(at(0.5f, 1.5f), 0.0f);  // there is none
  EXPECT_EQ(at(11.5f, 0.5f), 0.0f);
  EXPECT_EQ(at(0.0f, 0.0f), 1001.0f);
  EXPECT_EQ(at(1.0f, 1.0f), 1001.0f);
  EXPECT_EQ(at(std::numeric_limits<float>::quiet_NaN(), 0.5f), 1001.0f);  // as all that is no number: 0
  EXPECT_NEAR(mean_color(udim).x, (1001.0f + 1002.0f + 1012.0f) / 3.0f, 1e-3f);
}

}  // namespace
}  // namespace twopass
