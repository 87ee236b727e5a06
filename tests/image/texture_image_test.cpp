#include "render/image/texture_image.h"

#include <list>

#include <gtest/gtest.h>

#include "render/image/read_texture.h"
#include "render/image/srgb.h"
#include "tests/image/files.h"

namespace twopass {
namespace {

// Values that no rule could guess.
float noise(int i) { return static_cast<float>((i * 7919 + 13) % 1009) / 1009.0f; }

Image noisy(int width, int height) {
  Image image(width, height, {"R", "G", "B"});
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = noise(static_cast<int>(i));
  return image;
}

C3d mean_of_level(const TextureImage& image, int level) {
  C3d sum(0.0);
  const V2i size = image.size(level);
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) sum += C3d(image.texel(level, x, y));
  return sum / (static_cast<double>(size.x) * size.y);
}

TEST(TextureImage, LevelsHalveDownToOneTexelAndKeepTheMean) {
  for (const V2i& size : {V2i(16, 8), V2i(37, 5), V2i(1, 9), V2i(1, 1)}) {
    const TextureImage image(noisy(size.x, size.y));
    EXPECT_EQ(image.size(0), size);
    EXPECT_EQ(image.size(image.level_count() - 1), V2i(1, 1));
    for (int level = 0; level < image.level_count(); ++level)
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(mean_of_level(image, level)[c], image.mean()[c], 1e-5) << size << " level " << level;
    if (image.level_count() > 1) {
      EXPECT_EQ(image.size(1), V2i(std::max(1, size.x / 2), std::max(1, size.y / 2)));
    }
  }
}

TEST(TextureImage, ALevelOfEvenSizeHoldsMeansOfFour) {
  const Image pixels = noisy(6, 4);
  const TextureImage image(pixels);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) {
      const C3f sum = pixels.rgb(2 * x, 2 * y) + pixels.rgb(2 * x + 1, 2 * y) + pixels.rgb(2 * x, 2 * y + 1) +
                      pixels.rgb(2 * x + 1, 2 * y + 1);
      EXPECT_NEAR((image.texel(1, x, y) - sum * 0.25f).length(), 0.0f, 1e-6f);
    }
}

TEST(TextureImage, BytesKeepTheirCodesAndAverageLight) {
  // Black and white alternate: half the light, whatever the curve.
  TexelLevel level{2, 2, TexelFormat::byte, {std::byte{0}, std::byte{255}, std::byte{255}, std::byte{0}}};
  std::vector<float> curve;
  for (int code = 0; code < 256; ++code) curve.push_back(srgb_decode(static_cast<float>(code) / 255.0f));
  const TextureImage image(level, 1, curve);
  EXPECT_EQ(image.texel(0, 1, 0), C3f(1.0f));
  EXPECT_EQ(image.texel(1, 0, 0), C3f(0.5f));
  EXPECT_LT(image.memory(), 2000u);
  const TexelPatch patch = image.patch(0, {1, 0}, {0, 1});
  EXPECT_EQ(patch.c00, C3f(1.0f));
  EXPECT_EQ(patch.c10, C3f(0.0f));
  EXPECT_EQ(patch.c01, C3f(0.0f));
  EXPECT_EQ(patch.c11, C3f(1.0f));
}

// Of every format and number of channels, at the very end of the level, too. Halfs: levels made of bytes.
TEST(TextureImage, MixesFourTexels) {
  std::vector<float> curve;
  for (int code = 0; code < 256; ++code) curve.push_back(srgb_decode(static_cast<float>(code) / 255.0f));
  std::list<TextureImage> images;
  images.emplace_back(noisy(5, 4));
  for (const int channels : {1, 3}) {
    TexelLevel level{10, 8, TexelFormat::byte, {}};
    for (int i = 0; i < 80 * channels; ++i) level.bytes.push_back(static_cast<std::byte>(255.0f * noise(i)));
    images.emplace_back(level, channels, curve);
  }
  const V2f at(0.3f, 0.9f);
  for (const TextureImage& image : images)
    for (int level = 0; level < 2; ++level) {
      const V2i size = image.size(level);
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
          const V2i columns(x, (x + 1) % size.x), rows(y, (y + 1) % size.y);
          const auto texel = [&](int i, int j) { return image.texel(level, i, j); };
          const C3f upper = texel(columns.x, rows.x) * (1.0f - at.x) + texel(columns.y, rows.x) * at.x,
                    lower = texel(columns.x, rows.y) * (1.0f - at.x) + texel(columns.y, rows.y) * at.x;
          EXPECT_EQ(image.mix(level, columns, rows, at), C3f(upper * (1.0f - at.y) + lower * at.y));
          EXPECT_EQ(image.patch(level, columns, rows).c01, texel(columns.x, rows.y));
        }
    }
}

TEST(TextureImage, TellsContentsApart) {
  const TextureImage a(noisy(5, 3)), b(noisy(5, 3)), c(noisy(3, 5));
  Image changed = noisy(5, 3);
  changed.at(4, 2, 2) += 1e-3f;
  const TextureImage d(changed);
  EXPECT_TRUE(a.has_same_texels(b));
  EXPECT_EQ(a.content_hash(), b.content_hash());
  EXPECT_FALSE(a.has_same_texels(c));
  EXPECT_NE(a.content_hash(), c.content_hash());
  EXPECT_FALSE(a.has_same_texels(d));
  EXPECT_NE(a.content_hash(), d.content_hash());
}

}  // namespace
}  // namespace twopass
