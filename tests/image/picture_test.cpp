#include "render/image/picture.h"

#include "render/image/srgb.h"
#include "tests/image/files.h"

namespace twopass {
namespace {

using Picture = FileTest;

TEST_F(Picture, ExrKeepsSceneLinearValues) {
  Image image(2, 1, {"R", "G", "B", "A"});
  image.pixels = {4.0f, 0.5f, 0.25f, 1.0f, 0.0f, 0.0f, 0.0f, 0.0f};
  write_picture(file("a.exr"), image, nullptr);
  EXPECT_EQ(read_picture(file("a.exr")).pixels, image.pixels);
}

TEST_F(Picture, DisplayFormatsReturnToLinearWithinTheirBits) {
  Image image(64, 1, {"R", "G", "B", "A", "Z"});
  for (int x = 0; x < 64; ++x)
    for (int c = 0; c < 5; ++c) image.at(x, 0, c) = static_cast<float>(x) / 63.0f;
  const DisplayTransform display;
  for (const char* name : {"a.png", "a.PNG", "a.tif"}) {
    write_picture(file(name), image, &display);
    const Image back = read_picture(file(name));
    EXPECT_EQ(back.channels.size(), 3u) << "colour alone";
    for (int x = 0; x < 64; ++x)
      EXPECT_NEAR(srgb_encode(back.rgb(x, 0).y), srgb_encode(image.rgb(x, 0).y), 1.01f / 255.0f);
  }
}

TEST_F(Picture, TheDisplayTransformIsApplied) {
  Image image(1, 1, {"R", "G", "B"});
  image.pixels = {1.0f, 1.0f, 1.0f};
  const DisplayTransform aces({.view = "ACES 1.0 - SDR Video"});
  write_picture(file("a.png"), image, &aces);
  EXPECT_NEAR(srgb_encode(read_picture(file("a.png")).rgb(0, 0).x), 0.8120f, 1.01f / 255.0f);
  write_picture(file("b.png"), image, nullptr);
  EXPECT_NEAR(read_picture(file("b.png")).rgb(0, 0).x, 1.0f, 1e-6f);
}

// Colours of other primaries come in as Rec.709; data, and ids that are called like colours, as they are.
TEST_F(Picture, OpenExrInOtherPrimariesIsConverted) {
  const std::vector<std::string> channels{"R",          "G",          "B",          "A",         "N.X",
                                          "crypto00.R", "crypto00.G", "crypto00.B", "light.R",   "light.G",
                                          "light.B",    "variance.R", "variance.G", "variance.B"};
  Image image(1, 1, channels);
  image.pixels = {0.613097f, 0.070194f, 0.020616f, 0.5f, 7.0f, 1.0f, 2.0f,
                  3.0f,      1.0f,      1.0f,      1.0f, 4.0f, 5.0f, 6.0f};
  ExrOptions options{.pixel_type = PixelType::float_, .color_space = "lin_ap1_scene"};
  options.metadata = {{"cryptomatte/0123456/name", std::string("crypto")}};
  write_exr(file("a.exr"), image, options);
  const Image back = read_picture(file("a.exr"));
  const float expected[] = {1.0f, 0.0f, 0.0f, 0.5f, 7.0f, 1.0f, 2.0f, 3.0f, 1.0f, 1.0f, 1.0f, 4.0f, 5.0f, 6.0f};
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const std::string name = (channels[c].starts_with("variance") ? "other_" : "") + channels[c];
    ASSERT_GE(back.channel(name), 0) << name;
    EXPECT_NEAR(back.pixels[static_cast<std::size_t>(back.channel(name))], expected[c], 1e-5f) << name;
  }
  EXPECT_EQ(read_exr(file("a.exr")).rgb(0, 0), image.rgb(0, 0)) << "the file itself";

  // A space without a name is told by its chromaticities; a file that says nothing is left alone.
  options.color_space = unknown_space;
  options.primaries = *find_interop_space("lin_ap1_scene");
  write_exr(file("b.exr"), image, options);
  EXPECT_NEAR(read_picture(file("b.exr")).rgb(0, 0).y, 0.0f, 1e-5f);
  options.primaries.reset();
  write_exr(file("c.exr"), image, options);
  EXPECT_EQ(read_picture(file("c.exr")).rgb(0, 0), image.rgb(0, 0));
}

TEST_F(Picture, UnknownExtensionsListTheKnownOnes) {
  const std::string message = error_of([&] { check_picture_path(file("a.bmp")); });
  EXPECT_TRUE(contains(message, ".exr, .png, .jpg, .jpeg, .tif, .tiff")) << message;
  EXPECT_THROW(check_picture_path(file("noextension")), Error);
  EXPECT_THROW(write_picture(file("a.bmp"), Image(1, 1, {"R", "G", "B"}), nullptr), Error);
  EXPECT_EQ(files_in_folder(), 0u);
}

TEST_F(Picture, PathsAreCheckedBeforeRendering) {
  check_picture_path(file("a.exr"));
  EXPECT_THROW(check_picture_path(file("none/a.exr")), Error);
  EXPECT_TRUE(is_display_referred("a.JPG"));
  EXPECT_FALSE(is_display_referred("a.exr"));
}

TEST_F(Picture, ColorsOfIntegersAreDecoded) {
  put(file("a.ppm"), std::string("P6 1 1 255\n\xbc\xbc\xbc"));
  EXPECT_NEAR(read_picture(file("a.ppm")).rgb(0, 0).x, 0.5028865f, 1e-5f);
}

}  // namespace
}  // namespace twopass
