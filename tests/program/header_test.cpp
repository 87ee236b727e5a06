// Headers and channels as other programs read them: the tools of OpenEXR and OpenImageIO. One picture with
// layers, light groups, Cryptomatte, a window and overscan, in one part and in many.
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "render/image/exr.h"
#include "tests/program/program.h"

namespace twopass {
namespace {

class Headers : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    const std::string picture = "render '" TWOPASS_SOURCE_DIR
                                "/scenes/cornell-box-specular/scene.xml' --size 48x32 --spp 2 --exr-type half "
                                "--aov light,denoise,P,Z,id,samples --light-groups --cryptomatte "
                                "object,material --crop 8,4,16,12 --overscan 3 "
                                "--quiet ";
    ASSERT_EQ(run(picture + "-o one.exr").exit_code, 0);
    ASSERT_EQ(run(picture + "--exr-parts layer --working-space ACEScg -o parts.exr").exit_code, 0);
  }
  // What another program says of a file.
  std::string tool(const std::string& command) const {
    const int status =
        std::system(("cd '" + folder_.string() + "' && " + command + " >tool.txt 2>&1 </dev/null").c_str());
    EXPECT_EQ(status, 0) << command;
    return read(folder_ / "tool.txt");
  }
};

// The whole header, but for values that differ between machines or versions.
TEST_F(Headers, ExrheaderReadsTheGoldenOne) {
  if (!is_installed("exrheader")) GTEST_SKIP() << "exrheader is not installed (openexr)";
  std::string header = tool("exrheader one.exr");
  header = std::regex_replace(
      header, std::regex("(twopass/(biasCi95|biasMean|scene|sceneFingerprint|version) \\(type [a-z]*\\): ).*"),
      "$1...");
  EXPECT_EQ(header, read(TWOPASS_SOURCE_DIR "/tests/program/golden/layers_header.txt"));
}

TEST_F(Headers, ExrinfoAcceptsBothFiles) {
  if (!is_installed("exrinfo")) GTEST_SKIP() << "exrinfo is not installed (openexr)";
  for (const std::string file : {"one.exr", "parts.exr"}) {
    // What it says counts: the exit code of OpenEXR 3.1.5's exrinfo is random, whatever the file.
    const std::string text = tool("(exrinfo -v " + file + "; true)");
    EXPECT_EQ(text.find("error"), std::string::npos) << text;
    for (const char* part :
         {"dataWindow: box2i [ 5, 1 - 26 18 ] 22 x 18", "displayWindow: box2i [ 0, 0 - 47 31 ] 48 x 32",
          "compression: compression 'zips'", "'diffuse_direct.R': half", "'N.Y': float", "'id.object': uint",
          "'CryptoMaterial00.A': float"})
      EXPECT_NE(text.find(part), std::string::npos) << file << ": " << part << "\n" << text;
  }
}

// A part for each layer: its name, channels and what they are, by OpenImageIO.
TEST_F(Headers, OpenImageIoFindsAPartForEachLayer) {
  if (!is_installed("oiiotool")) GTEST_SKIP() << "oiiotool is not installed (openimageio-tools)";
  struct Part {
    std::string channels, space, windows;
  };
  std::map<std::string, Part> parts;
  Part part;
  std::istringstream lines(tool("oiiotool --info -v -a parts.exr"));
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_search(line, match, std::regex("^ *channel list: (.*)"))) part = {match[1], "", ""};
    if (std::regex_search(line, match, std::regex("^ *colorInteropID: \"(.*)\""))) part.space = match[1];
    if (std::regex_search(line, match, std::regex("^ *(pixel data origin|full/display size): (.*)")))
      part.windows += std::string(match[2]) + "; ";
    if (std::regex_search(line, match, std::regex("^ *oiio:subimagename: \"(.*)\""))) parts[match[1]] = part;
  }
  std::map<std::string, std::string> expected{{"rgba", "R, G, B, A"},           {"N", "N.X, N.Y, N.Z"},
                                              {"P", "P.X, P.Y, P.Z"},           {"Z", "Z"},
                                              {"id", "id.material, id.object"}, {"samples", "samples.X"}};
  for (const std::string layer :
       {"emission", "background", "diffuse_direct", "diffuse_indirect", "specular_direct", "specular_indirect",
        "transmission_direct", "transmission_indirect", "albedo", "light_lamp", "CryptoObject00",
        "CryptoObject01", "CryptoObject02", "CryptoMaterial00", "CryptoMaterial01", "CryptoMaterial02"})
    expected[layer] = layer + ".R, " + layer + ".G, " + layer + ".B" +
                      (layer.starts_with("Crypto") ? ", " + layer + ".A" : "");
  for (const auto& [name, channels] : expected) {
    ASSERT_TRUE(parts.contains(name)) << name;
    EXPECT_EQ(parts[name].channels, channels);
    const bool is_data = channels.find(".R") == std::string::npos && name != "rgba";
    EXPECT_EQ(parts[name].space, is_data || name.starts_with("Crypto") ? "data" : "lin_ap1_scene") << name;
    EXPECT_EQ(parts[name].windows, "x=5, y=1; 48 x 32; ") << name;
  }
  EXPECT_EQ(parts.size(), expected.size());
}

// Pixels that OpenImageIO reads and writes again are ours, and those in parts are those in one.
TEST_F(Headers, OpenImageIoReadsTheSamePixels) {
  if (!is_installed("oiiotool")) GTEST_SKIP() << "oiiotool is not installed (openimageio-tools)";
  tool("oiiotool one.exr -o back.exr");
  const Image ours = read_exr(folder_ / "one.exr"), theirs = read_exr(folder_ / "back.exr"),
              parts = read_exr(folder_ / "parts.exr");
  ASSERT_EQ(ours.channels, theirs.channels);
  const auto expect_equal = [](const Image& a, const Image& b, const std::string& name) {
    ASSERT_GE(b.channel(name), 0) << name;
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x)
        ASSERT_EQ(a.at(x, y, a.channel(name)), b.at(x, y, b.channel(name))) << name << " " << x << "," << y;
  };
  // Of channels of several types oiiotool makes floats, and of whole numbers fractions of the largest: by
  // themselves they stay what they are.
  for (const std::string& name : ours.channels)
    if (!name.starts_with("id.")) expect_equal(ours, theirs, name);
  tool("oiiotool parts.exr --subimage id -o id.exr");
  for (const std::string name : {"id.object", "id.material"})
    expect_equal(parts, read_exr(folder_ / "id.exr"), name);
  EXPECT_EQ(std::set<std::string>(parts.channels.begin(), parts.channels.end()),
            std::set<std::string>(ours.channels.begin(), ours.channels.end()));
  for (const std::string name :
       {"Z", "P.X", "id.object", "CryptoObject00.R", "CryptoObject00.G", "samples.X", "A"})
    expect_equal(ours, parts, name);
}

}  // namespace
}  // namespace twopass
