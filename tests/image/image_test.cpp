#include "render/image/image.h"

#include "tests/image/files.h"

namespace twopass {
namespace {

TEST(Image, PixelsAreInterleavedFromTheTopLeft) {
  Image image(3, 2, {"R", "G", "B", "Z"});
  ASSERT_EQ(image.pixels.size(), 24u);
  image.at(2, 1, 3) = 7.0f;
  EXPECT_EQ(image.pixels.back(), 7.0f);
  image.at(1, 0, 0) = 5.0f;
  EXPECT_EQ(image.pixels[4], 5.0f);
}

TEST(Image, ColorIsFoundByNameWhateverTheOrder) {
  Image image(1, 1, {"A", "B", "G", "R"});
  image.pixels = {0.5f, 3.0f, 2.0f, 1.0f};
  EXPECT_EQ(image.rgb(0, 0), C3f(1.0f, 2.0f, 3.0f));
  EXPECT_EQ(image.channel("A"), 0);
  EXPECT_EQ(image.channel("albedo.R"), -1);
}

TEST(Image, LuminanceAloneIsGrey) {
  Image image(1, 1, {"Y"});
  image.pixels = {0.25f};
  EXPECT_EQ(rgb_pixels(image).at(0), C3f(0.25f, 0.25f, 0.25f));
}

TEST(Image, WithoutColorIsAnError) {
  const Image image(1, 1, {"Z", "albedo.R"});
  EXPECT_TRUE(contains(error_of([&] { (void)rgb_pixels(image, "depth.exr"); }), "depth.exr: "));
}

TEST(Image, LuminanceOfWhiteIsOne) { EXPECT_FLOAT_EQ(luminance({1.0f, 1.0f, 1.0f}), 1.0f); }

}  // namespace
}  // namespace twopass
