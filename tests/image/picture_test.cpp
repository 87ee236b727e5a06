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
      EXPECT_NEAR(srgb_encode(back.rgb(x, 0).y), srgb_encode(image.rgb(x, 0).y), 0.6f / 255.0f);
  }
}

TEST_F(Picture, TheDisplayTransformIsApplied) {
  Image image(1, 1, {"R", "G", "B"});
  image.pixels = {1.0f, 1.0f, 1.0f};
  const DisplayTransform aces({.view = "ACES 1.0 - SDR Video"});
  write_picture(file("a.png"), image, &aces);
  EXPECT_NEAR(srgb_encode(read_picture(file("a.png")).rgb(0, 0).x), 0.8120f, 0.6f / 255.0f);
  write_picture(file("b.png"), image, nullptr);
  EXPECT_NEAR(read_picture(file("b.png")).rgb(0, 0).x, 1.0f, 1e-6f);
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
