#include "render/image/raster_file.h"

#include <chrono>
#include <cstdlib>
#include <thread>

#include "tests/image/files.h"

namespace twopass {
namespace {

using RasterFile = FileTest;

TEST_F(RasterFile, PngKeepsEightBits) {
  Image image(256, 1, {"R", "G", "B"});
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<float>(i / 3) / 255.0f;
  write_raster(file("a.png"), image);
  const RasterImage back = read_raster(file("a.png"));
  EXPECT_TRUE(back.display_referred);
  EXPECT_EQ(back.image.channels, (std::vector<std::string>{"R", "G", "B"}));
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    EXPECT_NEAR(back.image.pixels[i], image.pixels[i], 1e-6f) << i;
}

TEST_F(RasterFile, TiffKeepsSixteenBits) {
  const Image image = random_image(31, 17, {"R", "G", "B"}, 0.0f, 1.0f);
  for (const char* name : {"a.tif", "a.tiff"}) {
    write_raster(file(name), image);
    const RasterImage back = read_raster(file(name));
    EXPECT_TRUE(back.display_referred);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      EXPECT_NEAR(back.image.pixels[i], image.pixels[i], 1.001f / 65535.0f) << "a step, dithered; " << i;
  }
}

// Each pixel of a plain area takes the upper step with the probability of the value's place between two: means
// and numbers of upper steps by z-tests, 72 of them at 5e-5 two-sided each (4.06 sigma), which fail once in 280
// runs of a right program; the numbers are the same in all runs. Uncorrelated with the next pixel and channel.
TEST_F(RasterFile, DitherKeepsTheMean) {
  constexpr double most_sigma = 4.06;
  constexpr int size = 128, count = size * size;
  for (const char* name : {"a.png", "a.tif"}) {
    const double steps = name[2] == 'p' ? 255.0 : 65535.0;
    for (const double place : {0.1, 0.25, 0.5, 0.9}) {
      Image image(size, size, {"R", "G", "B"});
      std::array<double, 3> value;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto stored =
            static_cast<float>((std::floor(0.3 * steps * static_cast<double>(c)) + place) / steps);
        value[c] = static_cast<double>(stored) * steps;
        for (std::size_t i = 0; i < count; ++i) image.pixels[3 * i + c] = stored;
      }
      write_raster(file(name), image, {1000, -7});
      const Image back = read_raster(file(name)).image;
      std::array<std::vector<double>, 3> z;  // of each pixel, of variance one
      for (std::size_t c = 0; c < 3; ++c) {
        const double low = std::floor(value[c]), p = value[c] - low, sigma = std::sqrt(p * (1.0 - p));
        double sum = 0.0;
        for (std::size_t i = 0; i < count; ++i) {
          const double step = static_cast<double>(back.pixels[3 * i + c]) * steps;
          ASSERT_LT(std::min(std::abs(step - low), std::abs(step - low - 1.0)), 0.01);
          z[c].push_back((step - value[c]) / sigma);
          sum += z[c].back();
        }
        EXPECT_LT(std::abs(sum) / std::sqrt(count), most_sigma) << name << " " << place << " channel " << c;
      }
      const auto expect_uncorrelated = [&](const std::vector<double>& a, const std::vector<double>& b,
                                           std::size_t shift) {
        double sum = 0.0;
        for (std::size_t i = 0; i + shift < count; ++i) sum += a[i] * b[i + shift];
        EXPECT_LT(std::abs(sum) / std::sqrt(count), most_sigma) << name << " " << place << " " << shift;
      };
      for (const std::size_t shift : {1, size}) expect_uncorrelated(z[1], z[1], shift);
      for (const std::size_t shift : {1, size}) expect_uncorrelated(z[0], z[2], shift);
      expect_uncorrelated(z[0], z[1], 0);
      expect_uncorrelated(z[1], z[2], 0);
    }
  }
}

// The pattern belongs to the frame: a part of a picture is dithered like the same part of the whole.
TEST_F(RasterFile, DitherFollowsThePlaceInTheFrame) {
  const Image whole = random_image(20, 10, {"R", "G", "B"}, 0.0f, 1.0f);
  Image part(7, 5, {"R", "G", "B"});
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 7; ++x)
      for (int c = 0; c < 3; ++c) part.at(x, y, c) = whole.at(x + 9, y + 4, c);
  write_raster(file("whole.png"), whole);
  write_raster(file("part.png"), part, {9, 4});
  const Image a = read_raster(file("whole.png")).image, b = read_raster(file("part.png")).image;
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 7; ++x) EXPECT_EQ(b.rgb(x, y), a.rgb(x + 9, y + 4));
}

TEST_F(RasterFile, JpegIsClose) {
  Image image(32, 32, {"R", "G", "B"});
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      image.at(x, y, 0) = static_cast<float>(x) / 31.0f;
      image.at(x, y, 1) = static_cast<float>(y) / 31.0f;
      image.at(x, y, 2) = 0.5f;
    }
  for (const char* name : {"a.jpg", "a.jpeg", "b.JPG"}) {
    write_raster(file(name), image);
    const Image back = read_raster(file(name)).image;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) EXPECT_NEAR(back.pixels[i], image.pixels[i], 0.03f);
  }
}

TEST_F(RasterFile, ValuesOutsideAreClampedAndNaNIsBlack) {
  Image image(4, 1, {"R", "G", "B"});
  image.pixels = {NAN, 2.0f, -1.0f, INFINITY, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 0.5f, 0.5f, 0.5f};
  write_raster(file("a.png"), image);
  const Image back = read_raster(file("a.png")).image;
  EXPECT_EQ(back.rgb(0, 0), C3f(0.0f, 1.0f, 0.0f));
  EXPECT_EQ(back.rgb(1, 0), C3f(0.0f, 0.0f, 1.0f));
}

TEST_F(RasterFile, SamePictureSameBytesAtAnyTime) {
  const Image image = random_image(20, 20, {"R", "G", "B"}, 0.0f, 1.0f);
  const std::vector<std::string> extensions{".png", ".jpg", ".tif"};
  for (const std::string& e : extensions) write_raster(file("first" + e), image);
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // time stamps count seconds
  for (const std::string& e : extensions) {
    write_raster(file("second" + e), image);
    EXPECT_EQ(content_of(file("first" + e)), content_of(file("second" + e))) << e;
  }
}

TEST_F(RasterFile, AlphaIsNotMultipliedIn) {
  put(file("a.png"), std::string_view(reinterpret_cast<const char*>(png_rgba), sizeof png_rgba));
  const RasterImage back = read_raster(file("a.png"));
  EXPECT_EQ(back.image.channels, (std::vector<std::string>{"R", "G", "B", "A"}));
  EXPECT_NEAR(back.image.at(0, 0, 0), 1.0f, 1e-6f);
  EXPECT_NEAR(back.image.at(0, 0, 3), 128.0f / 255.0f, 1e-6f);
  EXPECT_NEAR(back.image.at(1, 0, 2), 3.0f / 255.0f, 1e-6f);
}

TEST_F(RasterFile, RadianceFilesAreSceneReferred) {
  put(file("a.hdr"), std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x40\x20\x82"));
  const RasterImage back = read_raster(file("a.hdr"));
  EXPECT_FALSE(back.display_referred);
  EXPECT_NEAR(back.image.rgb(0, 0).x, 2.0f, 0.02f);
  EXPECT_NEAR(back.image.rgb(0, 0).y, 1.0f, 0.02f);
}

TEST_F(RasterFile, GreyPicturesAreLuminance) {
  put(file("a.pgm"), std::string("P5 2 1 255\n\x33\xff"));
  const RasterImage back = read_raster(file("a.pgm"));
  EXPECT_EQ(back.image.channels, std::vector<std::string>{"Y"});
  EXPECT_NEAR(back.image.rgb(0, 0).y, 0.2f, 1e-6f);
}

TEST_F(RasterFile, ErrorsNameTheFile) {
  EXPECT_TRUE(
      contains(error_of([&] { (void)read_raster(file("none.png")); }), "none.png: there is no such file"));
  EXPECT_TRUE(contains(error_of([&] { (void)read_raster(folder()); }), "folder"));
  put(file("text.png"), "no picture");
  EXPECT_TRUE(contains(error_of([&] { (void)read_raster(file("text.png")); }), "text.png: it cannot be read"));
  EXPECT_TRUE(contains(error_of([&] { write_raster(file("a.xyz"), Image(1, 1, {"R", "G", "B"})); }), "a.xyz"));
  EXPECT_TRUE(contains(error_of([&] {
                         write_raster(file("none/a.png"), Image(1, 1, {"R", "G", "B"}));
                       }),
                       "none"));
}

TEST_F(RasterFile, ATruncatedFileIsAnError) {
  write_raster(file("a.tif"), random_image(64, 64, {"R", "G", "B"}, 0.0f, 1.0f));
  const std::string whole = content_of(file("a.tif"));
  for (const double part : {0.0, 0.01, 0.5, 0.99}) {
    put(file("cut.tif"), whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
    EXPECT_THROW((void)read_raster(file("cut.tif")), Error) << part;
  }
}

TEST_F(RasterFile, AFullDiskIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  std::filesystem::create_symlink("/dev/full", file("a.png"));
  EXPECT_TRUE(contains(error_of([&] { write_raster(file("a.png"), Image(8, 8, {"R", "G", "B"})); }), "space"));
}

// Runs in a copy of this program that stands where no module is.
TEST(MissingModule, DISABLED_Child) {
  const std::string message = error_of([] { write_raster("/dev/null.png", Image(1, 1, {"R", "G", "B"})); });
  EXPECT_TRUE(contains(message, "twopass_oiio.so: ")) << message;
  EXPECT_TRUE(contains(message, "use .exr")) << message;
}

TEST_F(RasterFile, AMissingModuleIsAClearError) {
  std::filesystem::copy_file("/proc/self/exe", file("program"));
  const std::string command =
      "'" + file("program").string() +
      "' --gtest_also_run_disabled_tests --gtest_filter=MissingModule.DISABLED_Child > '" +
      file("log").string() + "' 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << content_of(file("log"));
  EXPECT_TRUE(contains(content_of(file("log")), "1 test from"));
}

TEST_F(RasterFile, TheInstalledLayoutIsFound) {
  std::filesystem::create_directories(file("bin"));
  std::filesystem::create_directories(file("lib/twopass"));
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  std::filesystem::copy_file("/proc/self/exe", file("bin/program"));
  std::filesystem::copy_file(here / "twopass_oiio.so", file("lib/twopass/twopass_oiio.so"));
  const std::string command =
      "'" + file("bin/program").string() + "' --gtest_filter=RasterFile.PngKeepsEightBits > /dev/null 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

}  // namespace
}  // namespace twopass
