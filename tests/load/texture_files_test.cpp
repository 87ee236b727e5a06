#include "render/load/texture_files.h"

#include "render/image/exr.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class TextureFilesTest : public LoadTest {
 protected:
  void write_picture(const std::string& name, float value, int width = 2, int height = 2) const {
    Image image(width, height, {"R", "G", "B"});
    std::ranges::fill(image.pixels, value);
    std::filesystem::create_directories((folder_ / name).parent_path());
    write_exr(folder_ / name, image, {.pixel_type = PixelType::float_});
  }
  [[nodiscard]] TextureRequest request(const std::string& name) const {
    return {.name = name, .folders = {folder_}, .where = "scene.xml:7"};
  }
};

const TextureImage* image_of(const Texture& texture) { return std::get<Bitmap>(texture).image.get(); }

TEST_F(TextureFilesTest, IdenticalImagesAreStoredOnce) {
  write_picture("a.exr", 0.5f);
  write_picture("b.exr", 0.5f);
  write_picture("c.exr", 0.25f);
  TextureFiles files({});
  TextureRequest clamped = request("a.exr");
  clamped.look.wrap_u = TextureWrap::clamp;
  const Texture a = files.load(request("a.exr"));
  EXPECT_EQ(image_of(a), image_of(files.load(clamped)));             // the same file
  EXPECT_EQ(image_of(a), image_of(files.load(request("./a.exr"))));  // by another name
  EXPECT_EQ(image_of(a), image_of(files.load(request("b.exr"))));    // the same texels
  EXPECT_NE(image_of(a), image_of(files.load(request("c.exr"))));
  EXPECT_EQ(std::get<Bitmap>(files.load(clamped)).wrap_u, TextureWrap::clamp);
}

TEST_F(TextureFilesTest, NamesMatchInAnyCaseAndWithBackSlashes) {
  write_picture("Textures/Wood.exr", 0.5f);
  TextureFiles files({});
  EXPECT_EQ(mean_color(files.load(request("textures\\WOOD.EXR"))), C3f(0.5f));
  write_picture("textures/wood.exr", 0.25f);
  EXPECT_EQ(mean_color(files.load(request("textures/wood.exr"))), C3f(0.25f));  // the exact name first
}

TEST_F(TextureFilesTest, ColourSpacesAreThoseOfTheConfigurationThatIsAskedFor) {
  write_picture("a.exr", 0.5f);
  // Half of ACES, whose white is that of Rec.709.
  const auto config =
      write("halved.ocio",
            "ocio_profile_version: 2\nroles: {default: aces, aces_interchange: aces}\n"
            "file_rules:\n  - !<Rule> {name: Default, colorspace: default}\n"
            "displays:\n  Screen:\n    - !<View> {name: Raw, colorspace: aces}\n"
            "colorspaces:\n  - !<ColorSpace> {name: aces}\n  - !<ColorSpace>\n    name: halved\n"
            "    to_scene_reference: !<MatrixTransform> "
            "{matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}\n");
  TextureRequest halved = request("a.exr");
  halved.texels.encoding = {.kind = TextureEncoding::Kind::color_space, .color_space = "halved"};
  TextureFiles files({.color_config = config.string()});
  const C3f mean = mean_color(files.load(halved));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], 0.25f, 1e-4f);
  expect_error([&] { TextureFiles({}).load(halved); }, {"scene.xml:7", "no colour space 'halved'"});
}

TEST_F(TextureFilesTest, MissingOnesNameTheFileAndWhoAsked) {
  TextureFiles files({});
  expect_error([&] { files.load(request("no.png")); },
               {"scene.xml:7", "there is no texture 'no.png'", "searched: ", "--missing-textures=pink"});
  TextureFiles pink({.missing = MissingTextures::pink});
  EXPECT_EQ(std::get<C3f>(pink.load(request("no.png"))), C3f(1, 0, 1));
  Notes notes;
  pink.report(notes);
  ASSERT_EQ(notes.lines().size(), 1u);
  EXPECT_NE(notes.lines()[0].find("no.png"), std::string::npos);
  // What is there but broken is an error in any case.
  write("broken.png", "no picture");
  expect_error([&] { pink.load(request("broken.png")); }, {"scene.xml:7", "broken.png", "cannot be read"});
}

TEST_F(TextureFilesTest, UdimTilesAreFoundByNumber) {
  write_picture("body.1001.exr", 1.0f);
  write_picture("body.1012.exr", 12.0f);
  TextureFiles files({});
  const Texture texture = files.load(request("body.<UDIM>.exr"));
  EXPECT_EQ(std::get<Udim>(texture).tiles.size(), 12u);
  EXPECT_EQ(number_at(texture, V2f(0.5f, 0.5f)), 1.0f);
  EXPECT_EQ(number_at(texture, V2f(1.5f, -0.5f)), 12.0f);
  EXPECT_EQ(number_at(texture, V2f(1.5f, 0.5f)), 0.0f);
  expect_error([&] { files.load(request("hand.<UDIM>.exr")); }, {"scene.xml:7", "hand.<UDIM>.exr"});
}

TEST_F(TextureFilesTest, MemoryIsBounded) {
  // Two of these take three quarters of a megabyte each; a sixteenth of 16 MB is one, half of it eight.
  for (int i = 0; i < 12; ++i)
    write_picture("big" + std::to_string(i) + ".exr", 0.1f * static_cast<float>(i), 220, 220);
  write_picture("huge.exr", 0.5f, 400, 400);
  TextureFiles files({.memory_megabytes = 16});
  EXPECT_TRUE(image_of(files.load(request("huge.exr")))->is_tiled());
  std::size_t resident = 0;
  int tiled = 0;
  for (int i = 0; i < 12; ++i) {
    const Texture texture = files.load(request("big" + std::to_string(i) + ".exr"));
    resident += image_of(texture)->memory();
    tiled += image_of(texture)->is_tiled() ? 1 : 0;
    EXPECT_NEAR(color_at(texture, V2f(0.5f, 0.5f)).x, 0.1f * static_cast<float>(i), 1e-6f);
  }
  EXPECT_LE(resident, std::size_t{8} << 20);
  EXPECT_GT(resident, std::size_t{6} << 20);
  EXPECT_GT(tiled, 0);
  EXPECT_EQ(files.tiled().size(), static_cast<std::size_t>(tiled) + 1);
}

TEST_F(TextureFilesTest, MitsubaScenes) {
  write_picture("a.exr", 0.5f);
  const auto reflectance = [&](const std::string& texture) {
    const LoadedScene loaded = load_xml("<scene version='0.6.0'><shape type='rectangle'><bsdf type='diffuse'>" +
                                        texture + "</bsdf></shape></scene>");
    return loaded.scene.materials.at(loaded.scene.shapes.at(0).material)
        .side[front]
        .diffuse_reflectance(V2f(0.3f, 0.4f));
  };
  const std::string bitmap = "type='bitmap'><string name='filename' value='a.exr'/>";
  EXPECT_EQ(reflectance("<texture name='reflectance' " + bitmap + "</texture>"), C3f(0.5f));
  EXPECT_EQ(reflectance("<texture name='reflectance' type='scale'><float name='scale' value='0.5'/><texture " +
                        bitmap + "</texture></texture>"),
            C3f(0.25f));
  EXPECT_EQ(reflectance("<texture name='reflectance' type='scale'><rgb name='scale' value='4,1,0'/><texture " +
                        bitmap + "</texture></texture>"),
            C3f(1.0f, 0.5f, 0.0f));
  EXPECT_EQ(
      reflectance("<texture name='reflectance' " + bitmap + "<string name='channel' value='g'/></texture>"),
      C3f(0.5f));
  EXPECT_EQ(reflectance("<texture name='reflectance' " + bitmap + "<float name='gamma' value='2'/></texture>"),
            C3f(0.25f));
  EXPECT_NEAR(
      reflectance("<texture name='reflectance' " + bitmap + "<boolean name='srgb' value='true'/></texture>").x,
      0.2140f, 1e-4f);
  expect_error([&] { reflectance("<texture name='reflectance' type='scale'/>"); },
               {"scene.xml:1", "holds no texture"});
  expect_error(
      [&] {
        reflectance("<texture name='reflectance' " + bitmap + "<string name='channel' value='q'/></texture>");
      },
      {"scene.xml:1", "'q'", "all, r, g, b, a"});
}

}  // namespace
}  // namespace twopass
