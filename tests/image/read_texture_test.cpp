#include "render/image/read_texture.h"

#include <limits>

#include "render/image/exr.h"
#include "render/image/raster_file.h"
#include "render/image/srgb.h"
#include "tests/image/files.h"

namespace twopass {
namespace {

using ReadTextureTest = FileTest;

C3f first_texel(const TexelOptions& options) {
  return read_texture(std::as_bytes(std::span(png_rgba)), options, "a.gltf").image->texel(0, 0, 0);
}

TEST_F(ReadTextureTest, EncodingsAndChannels) {
  using Kind = TextureEncoding::Kind;
  const float half = 128.0f / 255.0f;
  EXPECT_EQ(first_texel({}), C3f(1.0f, srgb_decode(half), 0.0f));
  EXPECT_EQ(first_texel({.encoding = {.kind = Kind::raw}}), C3f(1.0f, half, 0.0f));
  EXPECT_EQ(first_texel({.encoding = {.kind = Kind::gamma, .gamma = 2.0f}}),
            C3f(1.0f, std::pow(half, 2.0f), 0.0f));
  EXPECT_EQ(first_texel({.encoding = {.kind = Kind::raw}, .channel = TextureChannel::green}), C3f(half));
  EXPECT_EQ(first_texel({.channel = TextureChannel::blue}), C3f(0.0f));
  EXPECT_EQ(first_texel({.channel = TextureChannel::alpha}), C3f(half));  // never decoded
  EXPECT_EQ(first_texel({.channel = TextureChannel::opacity}), C3f(half));
}

TEST_F(ReadTextureTest, WithoutAlphaAllIsOpaque) {
  Image image(2, 1, {"R", "G", "B"});
  image.pixels = {0.25f, 0.5f, 0.75f, 0, 0, 0};
  write_exr(file("a.exr"), image, {.pixel_type = PixelType::float_});
  EXPECT_EQ(read_texture(file("a.exr"), {.channel = TextureChannel::alpha}).image->texel(0, 0, 0), C3f(1.0f));
  EXPECT_EQ(read_texture(file("a.exr"), {.channel = TextureChannel::opacity}).image->texel(0, 0, 0),
            C3f(0.25f, 0.5f, 0.75f));
}

TEST_F(ReadTextureTest, FileAndMemoryAgree) {
  write_raster(file("a.png"), random_image(19, 7, {"R", "G", "B"}, 0.0f, 1.0f));
  const std::string bytes = content_of(file("a.png"));
  const ReadTexture a = read_texture(file("a.png"), {}),
                    b = read_texture(std::as_bytes(std::span(bytes)), {}, "memory");
  EXPECT_TRUE(a.image->has_same_texels(*b.image));
  const Image decoded = read_raster(file("a.png")).image;
  for (int x = 0; x < 19; ++x) EXPECT_FLOAT_EQ(a.image->texel(0, x, 3).y, srgb_decode(decoded.at(x, 3, 1)));
}

TEST_F(ReadTextureTest, ValuesThatAreNoNumbersAreCountedAndReadAsZero) {
  Image image(3, 1, {"R", "G", "B"});
  image.pixels = {std::numeric_limits<float>::quiet_NaN(), -1.0f, 2.0f, infinity_f, 1, 1, 1, 1, 1};
  // Our own writer refuses such values: as a PFM, three floats a pixel, rows from the bottom.
  std::string pfm = "PF\n3 1\n-1.0\n";
  pfm.append(reinterpret_cast<const char*>(image.pixels.data()), image.pixels.size() * sizeof(float));
  put(file("a.pfm"), pfm);
  const ReadTexture read = read_texture(file("a.pfm"), {.range = TexelRange::unit});
  EXPECT_EQ(read.not_finite, 2u);
  EXPECT_EQ(read.image->texel(0, 0, 0), C3f(0.0f, 0.0f, 1.0f));
  EXPECT_EQ(read.image->texel(0, 1, 0), C3f(0.0f, 1.0f, 1.0f));
  EXPECT_EQ(read_texture(file("a.pfm"), {}).image->texel(0, 0, 0), C3f(0.0f, -1.0f, 2.0f));
}

TEST_F(ReadTextureTest, ColorSpacesAreThoseOfOpenColorIO) {
  Image image(1, 1, {"R", "G", "B"});
  image.pixels = {0.2f, 0.4f, 0.6f};
  write_exr(file("a.exr"), image, {.pixel_type = PixelType::float_});
  const auto read = [&](const char* name) {
    return read_texture(file("a.exr"),
                        {.encoding = {.kind = TextureEncoding::Kind::color_space, .color_space = name}})
        .image->texel(0, 0, 0);
  };
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(read("lin_rec709_scene")[c], image.pixels[static_cast<std::size_t>(c)], 1e-6f);
  const std::string error = error_of([&] { read("mud"); });
  EXPECT_TRUE(contains(error, "a.exr")) << error;
  EXPECT_TRUE(contains(error, "no colour space 'mud'")) << error;
  EXPECT_TRUE(contains(error, "Linear Rec.709 (sRGB)")) << error;
}

// ACEScg's pure green in Rec.709 (Bradford), as OpenColorIO's and other tables have it: -0.62, 1.14, -0.13.
TEST_F(ReadTextureTest, LinearColoursAreInThePrimariesThatTheFileNames) {
  Image image(64, 64, {"R", "G", "B"});
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) image.pixels[i + 1] = 1.0f;
  write_exr(file("cg.exr"), image, {.pixel_type = PixelType::float_, .color_space = "lin_ap1_scene"});
  write_exr(file("plain.exr"), image, {.pixel_type = PixelType::float_});
  const C3f expected(-0.62179f, 1.14080f, -0.12897f);
  for (const std::size_t most_bytes : {std::size_t{1} << 30, std::size_t{1000}}) {  // whole, and by tiles
    const auto texel = [&](const char* name, const TexelOptions& options) {
      return read_texture(file(name), options, most_bytes).image->texel(0, 3, 5);
    };
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(texel("cg.exr", {})[c], expected[c], 1e-3f);
    EXPECT_EQ(texel("cg.exr", {.range = TexelRange::unit}), C3f(0.0f, 1.0f, 0.0f));
    EXPECT_EQ(texel("cg.exr", {.encoding = {.kind = TextureEncoding::Kind::raw}}), C3f(0.0f, 1.0f, 0.0f));
    EXPECT_EQ(texel("plain.exr", {}), C3f(0.0f, 1.0f, 0.0f));
  }
}

TEST_F(ReadTextureTest, WhatIsTooLargeIsReadByTiles) {
  write_raster(file("a.png"), random_image(150, 70, {"R", "G", "B"}, 0.0f, 1.0f));
  const ReadTexture whole = read_texture(file("a.png"), {}), tiled = read_texture(file("a.png"), {}, 1000);
  EXPECT_FALSE(whole.image->is_tiled());
  ASSERT_TRUE(tiled.image->is_tiled());
  EXPECT_LT(tiled.image->memory(), 2000u);
  ASSERT_EQ(tiled.image->level_count(), whole.image->level_count());
  double worst_coarse = 0.0;
  for (int level = 0; level < whole.image->level_count(); ++level) {
    const V2i size = whole.image->size(level);
    ASSERT_EQ(tiled.image->size(level), size);
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const C3f difference = tiled.image->texel(level, x, y) - whole.image->texel(level, x, y);
        // Half floats are good for 11 bits. Where sizes are odd OpenImageIO makes its levels of fewer texels.
        if (level <= 1) {
          EXPECT_LT(max_abs_component(difference), 6e-4f) << level << ": " << x << ", " << y;
        }
        worst_coarse = std::max<double>(worst_coarse, max_abs_component(difference));
      }
  }
  EXPECT_LT(worst_coarse, 0.3);
  EXPECT_NEAR(tiled.image->mean().x, whole.image->mean().x, 0.05);
  EXPECT_EQ(tiled.image->unreadable_tiles(), 0u);
}

TEST_F(ReadTextureTest, ABrokenEndShowsWhenItIsLookedAt) {
  write_raster(file("a.png"), random_image(300, 300, {"R", "G", "B"}, 0.0f, 1.0f));
  const std::string bytes = content_of(file("a.png"));
  put(file("b.png"), bytes.substr(0, bytes.size() / 2));
  EXPECT_TRUE(contains(error_of([&] { read_texture(file("b.png"), {}); }), "b.png: it cannot be read"));
  const ReadTexture tiled = read_texture(file("b.png"), {}, 1000);
  EXPECT_EQ(tiled.image->texel(0, 299, 299), C3f(0.0f));
  EXPECT_GT(tiled.image->unreadable_tiles(), 0u);
}

TEST_F(ReadTextureTest, ErrorsNameTheFile) {
  EXPECT_TRUE(contains(error_of([&] { read_texture(file("no.png"), {}); }), "no.png"));
  std::filesystem::create_directory(file("d.png"));
  EXPECT_TRUE(contains(error_of([&] { read_texture(file("d.png"), {}); }), "d.png"));
  put(file("text.png"), "no picture");
  EXPECT_TRUE(contains(error_of([&] { read_texture(file("text.png"), {}); }), "text.png: it cannot be read"));
  const std::string text = "neither";
  EXPECT_TRUE(contains(error_of([&] { read_texture(std::as_bytes(std::span(text)), {}, "a.glb: image 3"); }),
                       "a.glb: image 3"));
  put(file("zero.pfm"), "PF\n0 0\n-1.0\n");
  EXPECT_TRUE(contains(error_of([&] { read_texture(file("zero.pfm"), {}); }), "zero.pfm"));
}

}  // namespace
}  // namespace twopass
