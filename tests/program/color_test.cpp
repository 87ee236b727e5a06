// Colour from the command line to the file: working spaces, views, looks, and other programs as judges.
#include <cmath>
#include <numeric>

#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include "render/image/color_config.h"
#include "render/image/picture.h"
#include "render/image/raster_file.h"
#include "render/image/srgb.h"
#include "tests/program/program.h"
#include "tests/support/viewer.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

class Colors : public Program {
 protected:
  // Diffuse surfaces in many colours and a texture, under one lamp. Light bounces once.
  void write_scene(const std::string& lamp) const {
    Image texture(8, 8, {"R", "G", "B"});
    for (std::size_t i = 0; i < texture.pixels.size(); ++i)
      texture.pixels[i] = 0.1f + 0.8f * static_cast<float>(i * 37 % 101) / 101.0f;
    write_exr(folder_ / "texture.exr", texture, {.pixel_type = PixelType::float_});
    write("scene.xml", R"(<scene version='3.0.0'>
      <sensor type='perspective'><float name='fov' value='60'/>
        <transform name='to_world'><lookat origin='0,1,4' target='0,0,0' up='0,1,0'/></transform>
        <film type='hdrfilm'><integer name='width' value='32'/><integer name='height' value='24'/>
          <rfilter type='box'/></film></sensor>
      <shape type='rectangle'><transform name='to_world'><scale value='3'/><rotate x='1' angle='-90'/>
          <translate y='-1'/></transform>
        <bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' value='texture.exr'/>
          </texture></bsdf></shape>
      <shape type='sphere'><point name='center' x='-1' y='0' z='0'/>
        <bsdf type='diffuse'><rgb name='reflectance' value='.8, .1, .05'/></bsdf></shape>
      <shape type='sphere'><point name='center' x='1' y='0' z='0'/>
        <bsdf type='diffuse'><rgb name='reflectance' value='.05, .7, .2'/></bsdf></shape>
      <shape type='rectangle'><transform name='to_world'><rotate x='1' angle='90'/><translate y='3'/></transform>
        <emitter type='area'><rgb name='radiance' value=')" +
                           lamp + R"('/></emitter></shape>
    </scene>)");
  }
  void good(const std::string& arguments, const std::string& environment = "") const {
    const Outcome result = run(arguments, environment);
    EXPECT_EQ(result.exit_code, 0) << arguments << "\n" << result.err;
  }
  // Runs another program in the folder; what it says.
  std::string tool(const std::string& command) const {
    const int status =
        std::system(("cd '" + folder_.string() + "' && " + command + " >tool.txt 2>&1 </dev/null").c_str());
    EXPECT_EQ(status, 0) << command << "\n" << read(folder_ / "tool.txt");
    return read(folder_ / "tool.txt");
  }
  [[nodiscard]] Image picture(const std::string& name) const { return read_picture(folder_ / name); }
  // The largest difference of the colours, relative to the largest of the pixel.
  static double difference(const Image& a, const Image& b) {
    const std::vector<C3f> x = rgb_pixels(a), y = rgb_pixels(b);
    double most = x.size() == y.size() ? 0.0 : 1e30;
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i)
      for (int c = 0; c < 3; ++c)
        most = std::max(most, std::abs(double{x[i][c]} - y[i][c]) /
                                  std::max({1e-3f, std::abs(y[i].x), std::abs(y[i].y), std::abs(y[i].z)}));
    return most;
  }
  const std::string one_bounce_ = "render scene.xml --integrator direct --spp 8 --exr-type float --quiet ";
};

std::string text_attribute(const fs::path& path, const char* name) {
  const Imf::InputFile file(path.c_str());
  const auto* attribute = file.header().findTypedAttribute<Imf::StringAttribute>(name);
  return attribute ? attribute->value() : "";
}

// White light that bounces once off a colour is that colour in any space: pictures are the same to rounding.
TEST_F(Colors, AWorkingSpaceIsAnotherWayToWriteTheSamePicture) {
  write_scene("9");
  good(one_bounce_ + "-o a.exr -o a.tif");
  for (const std::string space : {"ACEScg", "ACES2065-1", "lin_ap1_scene"}) {
    good(one_bounce_ + "--working-space " + space + " -o b.exr -o b.tif");
    const Image stored = read_exr(folder_ / "b.exr");
    EXPECT_GT(difference(stored, picture("a.exr")), 0.05) << "other numbers";
    EXPECT_LT(difference(picture("b.exr"), picture("a.exr")), 2e-5) << space;
    const Image shown = picture("b.tif"), expected = picture("a.tif");
    for (std::size_t i = 0; i < shown.pixels.size(); ++i)
      EXPECT_NEAR(shown.pixels[i], expected.pixels[i], 1e-4f);
    EXPECT_EQ(text_attribute(folder_ / "b.exr", "colorInteropID"),
              space == "ACES2065-1" ? "lin_ap0_scene" : "lin_ap1_scene");
    EXPECT_EQ(text_attribute(folder_ / "b.exr", "twopass/workingSpace"),
              space == "ACES2065-1" ? "ACES2065-1" : "ACEScg");
    EXPECT_EQ(run("compare b.exr a.exr --max relmse=1e-9").exit_code, 0) << "compared in one space";
  }
  const Imf::InputFile file((folder_ / "b.exr").c_str());
  ASSERT_TRUE(Imf::hasChromaticities(file.header()));
  EXPECT_FLOAT_EQ(Imf::chromaticities(file.header()).red.x, 0.713f);
}

// Coloured light: products of colours are other colours in other primaries, by exactly as much as the product
// of the converted ones is another than the converted product.
TEST_F(Colors, ProductsDifferAsProductsOfTheSpacesDo) {
  write("scene.xml", R"(<scene version='3.0.0'><sensor type='orthographic'>
      <transform name='to_world'><lookat origin='0,0,4' target='0,0,0' up='0,1,0'/></transform>
      <film type='hdrfilm'><integer name='width' value='4'/><integer name='height' value='4'/></film></sensor>
    <shape type='rectangle'><bsdf type='diffuse'><rgb name='reflectance' value='.8, .3, .1'/></bsdf></shape>
    <emitter type='directional'><vector name='direction' x='0' y='0' z='-1'/>
      <rgb name='irradiance' value='2, 5, 9'/></emitter></scene>)");
  good(one_bounce_ + "-o a.exr");
  good(one_bounce_ + "--working-space ACEScg -o b.exr");
  const WorkingSpace space = find_working_space("ACEScg", "");
  const C3f albedo(0.8f, 0.3f, 0.1f), light(2, 5, 9);
  const C3f plain = albedo * light / pi_f,
            expected = space.from_rec709(albedo) * space.from_rec709(light) / pi_f;
  const C3f a = read_exr(folder_ / "a.exr").rgb(1, 1), b = read_exr(folder_ / "b.exr").rgb(1, 1);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(a[c], plain[c], 1e-5f * plain[c]);
    EXPECT_NEAR(b[c], expected[c], 2e-5f * expected[c]);
  }
  EXPECT_GT(std::abs(space.to_rec709(expected).x / plain.x - 1.0f), 0.01f) << "the difference is to be seen";
}

TEST_F(Colors, SpacesWithoutANameAreTaggedByTheirPrimaries) {
  write_scene("9");
  std::string config(builtin_ocio_config());
  config +=
      "  - !<ColorSpace>\n    name: our own\n    encoding: scene-linear\n    to_scene_reference: "
      "!<GroupTransform>\n      children:\n"
      "        - !<MatrixTransform> {matrix: [0.98, 0, 0.02, 0, 0, 0.98, 0.02, 0, 0.02, 0.02, 0.96, 0, 0, 0, "
      "0, 1]}\n"
      "        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}\n";
  write("config.ocio", config);
  good(one_bounce_ + "-o a.exr");
  good(one_bounce_ + "--ocio config.ocio --working-space 'our own' -o b.exr -o b.png --slice 1/1");
  EXPECT_EQ(run("merge b.exr -o c.exr").exit_code, 1) << "the built-in configuration does not know it";
  good("merge b.exr --ocio config.ocio -o c.exr -o c.png --exr-type float");
  EXPECT_EQ(text_attribute(folder_ / "c.exr", "colorInteropID"), "unknown");
  EXPECT_LT(difference(picture("c.exr"), picture("a.exr")), 2e-5);
  EXPECT_EQ(read(folder_ / "b.png"), read(folder_ / "c.png"));
}

// Linear colours of the vertices of a file of write_ply.
std::vector<C3f> ply_colors(const std::string& file) {
  const std::size_t begin = file.find("end_header\n") + 11,
                    count = std::stoul(file.substr(file.find("element vertex ") + 15));
  constexpr std::size_t vertex_bytes = 3 * sizeof(float) + 3;
  std::vector<C3f> colors;
  for (std::size_t i = 0; i < count; ++i) {
    C3f color;
    for (std::size_t c = 0; c < 3; ++c)
      color[static_cast<int>(c)] = srgb_decode(
          static_cast<float>(static_cast<unsigned char>(file.at(begin + vertex_bytes * i + 12 + c))) / 255.0f);
    colors.push_back(color);
  }
  return colors;
}

TEST_F(Colors, SolutionsAreOfAWorkingSpaceAndLookTheSame) {
  write_scene("9");
  const std::string solve = "solve scene.xml --elements 300 --max-reflections 0 --quiet ";
  good(solve + "-o a.ply");
  good(solve + "--working-space ACEScg -o b.ply -o b.radiosity");
  const std::vector<C3f> a = ply_colors(read(folder_ / "a.ply")), b = ply_colors(read(folder_ / "b.ply"));
  ASSERT_EQ(a.size(), b.size());
  // The same hues; the exposure, one factor for all, looks at the brightest channel and may differ.
  std::vector<double> ratios;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int c = 0; c < 3; ++c)
      if (max_component(a[i]) < 0.95f && max_component(b[i]) < 0.95f && a[i][c] > 0.05f)
        ratios.push_back(double{b[i][c]} / a[i][c]);
  ASSERT_GT(ratios.size(), 100u);
  std::sort(ratios.begin(), ratios.end());
  const double middle = ratios[ratios.size() / 2];
  EXPECT_NEAR(ratios.front() / middle, 1.0, 0.06) << "8 bits each";
  EXPECT_NEAR(ratios.back() / middle, 1.0, 0.06);

  good("solve scene.xml --elements 300 --working-space ACEScg -o c.radiosity --quiet");
  const std::string render = "render scene.xml --solution c.radiosity --spp 1 -o c.exr --quiet ";
  good(render + "--working-space ACEScg");
  const Outcome other = run(render);
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_NE(other.err.find("--working-space"), std::string::npos) << other.err;
}

TEST_F(Colors, ViewersSeeRec709) {
  write_scene("9");
  good(one_bounce_ + "-o a.exr");
  test::Viewer viewer;
  good(one_bounce_ + "--working-space ACEScg -o b.exr --preview " + viewer.address());
  const Image expected = picture("a.exr");
  const auto all = viewer.pictures();
  ASSERT_EQ(all.size(), 1u);
  const test::ViewedPicture& seen = all.begin()->second;
  for (std::size_t i = 0; i < expected.pixel_count(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = expected.pixels[i * expected.channels.size() + c];
      ASSERT_NEAR(seen.planes[c][i], value, 2e-5f * std::max(1.0f, value));
    }
}

TEST_F(Colors, WhatCannotBeIsOneErrorThatNamesTheChoices) {
  const std::pair<std::string, std::string> cases[] = {{"--working-space ACEScq", "ACEScg"},
                                                       {"--working-space 'sRGB - Texture'", "not linear"},
                                                       {"--working-space Raw", "data"},
                                                       {"-o a.png --display Beamer", "sRGB - Display"},
                                                       {"-o a.png --view Sepia", "Un-tone-mapped"},
                                                       {"-o a.png --look Noir", "--look"}};
  for (const auto& [arguments, part] : cases) {
    const Outcome result = run("render " + box_ + "--spp 1 -o a.exr --quiet " + arguments);
    EXPECT_EQ(result.exit_code, 1) << arguments;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(folder_ / "a.exr"));
  }
}

TEST_F(Colors, APartIsDitheredAsInTheWhole) {
  good("render " + box_ + "--integrator path --spp 2 -o all.png --quiet");
  good("render " + box_ + "--integrator path --spp 2 --crop 7,5,20,16 --overscan 2 -o part.png --quiet");
  const Image all = picture("all.png"), part = picture("part.png");
  ASSERT_EQ(part.width, 20);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 20; ++x) ASSERT_EQ(part.rgb(x, y), all.rgb(x + 7, y + 5));
}

// --- Other programs as judges ---

// OpenImageIO makes of our linear pictures what we made of them.
TEST_F(Colors, OiiotoolSeesTheSameThroughTheSameView) {
  if (!is_installed("oiiotool")) GTEST_SKIP() << "oiiotool is not installed (openimageio-tools)";
  write_scene("9");
  write("config.ocio", std::string(builtin_ocio_config()));
  for (const std::string view : {"Un-tone-mapped", "ACES 1.0 - SDR Video"})
    for (const std::string space : {"Linear Rec.709 (sRGB)", "ACEScg"}) {
      good(one_bounce_ + "--working-space '" + space + "' --view '" + view + "' -o a.exr -o a.tif");
      tool("oiiotool --colorconfig config.ocio a.exr --ch R,G,B --ociodisplay:from='" + space +
           "' 'sRGB - Display' '" + view + "' --clamp:min=0:max=1 -d float -o b.exr");
      const Image ours = read_raster(folder_ / "a.tif").image, theirs = read_exr(folder_ / "b.exr");
      ASSERT_EQ(ours.pixels.size(), theirs.pixels.size());
      for (std::size_t i = 0; i < ours.pixels.size(); ++i)
        ASSERT_NEAR(ours.pixels[i], theirs.pixels[i], 1.1f / 65535.0f + 3e-6f) << view << " from " << space;
    }
}

TEST_F(Colors, OiiotoolConvertsOurPicturesIntoEachOther) {
  if (!is_installed("oiiotool")) GTEST_SKIP() << "oiiotool is not installed (openimageio-tools)";
  write_scene("9");
  write("config.ocio", std::string(builtin_ocio_config()));
  good(one_bounce_ + "-o a.exr");
  good(one_bounce_ + "--working-space ACEScg -o b.exr");
  tool(
      "oiiotool --colorconfig config.ocio b.exr --ch R,G,B --colorconvert ACEScg 'Linear Rec.709 (sRGB)' -d "
      "float "
      "-o c.exr");
  EXPECT_LT(difference(read_exr(folder_ / "c.exr"), read_exr(folder_ / "a.exr")), 2e-5);
  tool(
      "oiiotool --colorconfig config.ocio a.exr --ch R,G,B --colorconvert 'Linear Rec.709 (sRGB)' ACEScg "
      "--colorconvert ACEScg 'Linear Rec.709 (sRGB)' -d float -o d.exr");
  EXPECT_LT(difference(read_exr(folder_ / "d.exr"), read_exr(folder_ / "a.exr")), 2e-6) << "there and back";
}

// A view that is a file of tables: what ociochecklut reads out of it stands in the picture.
TEST_F(Colors, OciochecklutReadsTheViewThatThePictureHas) {
  if (!is_installed("ociochecklut")) GTEST_SKIP() << "ociochecklut is not installed (opencolorio-tools)";
  write("view.clf", R"(<?xml version="1.0" encoding="UTF-8"?>
<ProcessList id="view" compCLFversion="3">
  <Matrix inBitDepth="32f" outBitDepth="32f"><Array dim="3 3">0.8 0.15 0.05  0.1 0.85 0.05  0.02 0.08 0.9</Array></Matrix>
  <LUT1D inBitDepth="32f" outBitDepth="32f"><Array dim="6 1">0 0.35 0.55 0.7 0.82 0.93</Array></LUT1D>
</ProcessList>)");
  write("config.ocio", R"(ocio_profile_version: 2
search_path: .
roles: {default: lin_rec709_scene, scene_linear: lin_rec709_scene, aces_interchange: lin_rec709_scene}
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  Screen:
    - !<View> {name: Table, colorspace: screen}
colorspaces:
  - !<ColorSpace>
    name: lin_rec709_scene
    encoding: scene-linear
  - !<ColorSpace>
    name: screen
    encoding: sdr-video
    from_scene_reference: !<FileTransform> {src: view.clf, interpolation: linear}
)");
  for (const std::string color :
       {"0.18 0.18 0.18", "0.9 0.02 0.4", "0.001 0.002 0.001", "1 1 1", "0.05 0.6 0.3"}) {
    std::string with_commas = color;
    std::replace(with_commas.begin(), with_commas.end(), ' ', ',');
    write("sky.xml", R"(<scene version='3.0.0'><sensor type='perspective'><film type='hdrfilm'>
      <integer name='width' value='2'/><integer name='height' value='2'/></film></sensor>
      <emitter type='constant'><rgb name='radiance' value=')" +
                         with_commas + R"('/></emitter></scene>)");
    good("render sky.xml --integrator path --spp 1 --ocio config.ocio -o a.tif --quiet");
    const std::string told = tool("ociochecklut view.clf " + color);
    float rgb[3] = {-1, -1, -1};
    ASSERT_EQ(std::sscanf(told.substr(told.rfind('\n', told.size() - 2) + 1).c_str(), "%f %f %f", &rgb[0],
                          &rgb[1], &rgb[2]),
              3)
        << told;
    const C3f seen = read_raster(folder_ / "a.tif").image.rgb(0, 0);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], rgb[c], 2e-5f) << color << "\n" << told;
  }
}

}  // namespace
}  // namespace twopass
