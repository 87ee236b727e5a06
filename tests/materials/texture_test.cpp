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

}  // namespace
}  // namespace twopass
