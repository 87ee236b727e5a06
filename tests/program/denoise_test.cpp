// --denoise, with libraries of our own in the place of Intel Open Image Denoise: what it is given, what becomes
// of what it returns, and what is said where it is missing or fails.
#include <algorithm>

#include "render/image/picture.h"
#include "tests/program/program.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

class Denoise : public Program {
 protected:
  // The environment in which the library of this version is found, and nothing else.
  [[nodiscard]] std::string with(const std::string& folder, const std::string& more = "") const {
    return "LD_LIBRARY_PATH='" + folder + "' FAKE_OIDN_LOG='" + (folder_ / "log.txt").string() + "' " + more;
  }
  // R, G, B are what the fake makes of the noisy picture and its guides.
  static void expect_filtered(const Image& image) {
    const auto channel = [&](const std::string& name) {
      EXPECT_GE(image.channel(name), 0) << name;
      return std::max(image.channel(name), 0);
    };
    const std::string color[] = {"R", "G", "B"}, axis[] = {"X", "Y", "Z"};
    for (int c = 0; c < 3; ++c) {
      const int out = channel(color[c]), noisy = channel("noisy." + color[c]),
                albedo = channel("albedo." + color[c]), normal = channel("N." + axis[c]);
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
          const float expected = 0.5f * std::max(image.at(x, y, noisy), 0.0f) +
                                 0.25f * 0.5f * std::clamp(image.at(x, y, albedo), 0.0f, 1.0f) +
                                 0.125f * 0.5f * std::clamp(image.at(x, y, normal), -1.0f, 1.0f);
          ASSERT_NEAR(image.at(x, y, out), expected, 1e-6f * std::max(1.0f, expected))
              << color[c] << x << "," << y;
        }
    }
  }
  const std::string render_ = "render " + box_ + "--spp 2 --exr-type float --threads 1 ";
};

TEST_F(Denoise, GivesTheLibraryThePictureAndItsGuidesAndKeepsTheNoisyOne) {
  ASSERT_EQ(run(render_ + "-o plain.exr --aov N,Z").exit_code, 0);
  const Image plain = read_picture(folder_ / "plain.exr");
  const std::pair<std::string, std::string> versions[] = {{FAKE_OIDN_2, "2.3.1"}, {FAKE_OIDN_1, "1.4.3"}};
  for (const auto& [folder, version] : versions) {
    fs::remove(folder_ / "log.txt");
    const Outcome result = run(render_ + "--denoise --aov Z -o a.exr -o a.tif", with(folder));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    ExrMetadata metadata;
    const Image image = read_exr(folder_ / "a.exr", &metadata);
    expect_filtered(image);
    EXPECT_NE(std::find(metadata.begin(), metadata.end(),
                        ExrMetadata::value_type("twopass/denoiser", "Intel Open Image Denoise " + version)),
              metadata.end());
    for (int y = 0; y < plain.height; ++y)
      for (int x = 0; x < plain.width; ++x) {
        for (const char* c : {"R", "G", "B"})
          ASSERT_EQ(image.at(x, y, image.channel(std::string("noisy.") + c)), plain.at(x, y, plain.channel(c)));
        for (const char* c : {"A", "Z", "N.Y"})
          ASSERT_EQ(image.at(x, y, image.channel(c)), plain.at(x, y, plain.channel(c)));
      }
    const Image shown = read_picture(folder_ / "a.tif");
    EXPECT_NEAR(shown.rgb(20, 20).y, std::min(1.0f, image.rgb(20, 20).y), 1e-3f) << "display formats, too";
    std::string expected = "new device 1\ndevice numThreads 1\n";
    const std::string frame = " format 3 40x40 offset 0 strides 12 480\n", end = "execute\nrelease filter\n";
    for (const std::string guide : {"albedo", "normal"})
      expected += "new filter RT\nimage " + guide + frame + "image output" + frame + end;
    expected += "new filter RT\nimage color" + frame + "image albedo" + frame + "image normal" + frame +
                "image output" + frame + "flag hdr on\nflag cleanAux on\n" + end + "release device\n";
    EXPECT_EQ(read(folder_ / "log.txt"), expected);
  }
}

TEST_F(Denoise, DisplayFormatsAloneNeedNoLayersInFiles) {
  EXPECT_EQ(run(render_ + "--denoise -o a.png", with(FAKE_OIDN_2)).exit_code, 0);
  EXPECT_EQ(read_picture(folder_ / "a.png").width, 40);
}

TEST_F(Denoise, SlicesAreDenoisedWhenTheyAreMerged) {
  const Outcome slice = run(render_ + "--slice 1/2 --denoise -o a.exr", with(FAKE_OIDN_2));
  EXPECT_EQ(slice.exit_code, 1);
  EXPECT_NE(slice.err.find("twopass merge"), std::string::npos) << slice.err;
  for (const char* k : {"1", "2"})
    ASSERT_EQ(run(render_ + "--aov denoise --slice " + k + "/2 -o " + k + ".exr").exit_code, 0);
  const Outcome merged = run("merge 1.exr 2.exr --denoise -o a.exr", with(FAKE_OIDN_2));
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  expect_filtered(read_picture(folder_ / "a.exr"));
  ASSERT_EQ(run(render_ + "--slice 1/2 -o bare.exr").exit_code, 0);
  const Outcome bare = run("merge bare.exr --denoise -o b.exr", with(FAKE_OIDN_2));
  EXPECT_EQ(bare.exit_code, 1);
  EXPECT_NE(bare.err.find("albedo"), std::string::npos) << bare.err;
}

TEST_F(Denoise, WithoutTheLibraryOneErrorSaysSoBeforeAnyWork) {
  fs::create_directories(folder_ / "empty");
  if (std::system("ldconfig -p 2>/dev/null | grep -q libOpenImageDenoise") == 0)
    GTEST_SKIP() << "Intel Open Image Denoise is installed";
  for (const std::string& arguments : {render_ + "-o a.exr", std::string("merge a.exr -o b.exr")}) {
    const Outcome result = run(arguments + " --denoise", "LD_LIBRARY_PATH=" + (folder_ / "empty").string());
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.err.find("--denoise: Intel Open Image Denoise is not installed"), std::string::npos)
        << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(folder_ / "a.exr"));
  }
}

TEST_F(Denoise, ErrorsOfTheLibraryAreReportedInOneLine) {
  for (const std::string function : {"oidnNewDevice", "oidnCommitDevice", "oidnExecuteFilter"}) {
    const Outcome result =
        run(render_ + "--denoise -o a.exr --quiet", with(FAKE_OIDN_2, "FAKE_OIDN_FAIL=" + function));
    EXPECT_EQ(result.exit_code, 1) << function;
    EXPECT_NE(result.err.find(function == "oidnNewDevice" ? "no such processor" : function), std::string::npos)
        << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    // What fails before the work leaves nothing, what fails after it the noisy picture.
    EXPECT_EQ(fs::exists(folder_ / "a.exr"), function == "oidnExecuteFilter");
  }
  ASSERT_EQ(run(render_ + "--aov denoise -o plain.exr").exit_code, 0);
  EXPECT_EQ(read_exr(folder_ / "a.exr").pixels, read_exr(folder_ / "plain.exr").pixels);
}

}  // namespace
}  // namespace twopass
