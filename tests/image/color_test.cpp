#include "render/image/color.h"

#include <cstdlib>
#include <vector>

#include "render/image/color_config.h"
#include "render/image/srgb.h"
#include "tests/image/files.h"

namespace twopass {
namespace {

// $OCIO for the life of a test.
class Color : public FileTest {
 protected:
  Color() { ::unsetenv("OCIO"); }
  ~Color() override { ::unsetenv("OCIO"); }

  // A configuration that the tests can tell from the built-in one: its only view is called `view`.
  std::string write_config(const std::string& name, const std::string& view, const std::string& role,
                           const std::string& space) const {
    put(file(name), "ocio_profile_version: 2\nstrictparsing: true\nroles:\n  default: raw\n" + role +
                        "file_rules:\n  - !<Rule> {name: Default, colorspace: default}\n"
                        "displays:\n  Screen:\n    - !<View> {name: " +
                        view +
                        ", colorspace: screen}\n"
                        "colorspaces:\n  - !<ColorSpace>\n    name: raw\n    isdata: true\n" +
                        space +
                        "  - !<ColorSpace>\n    name: screen\n    encoding: sdr-video\n"
                        "    from_scene_reference: !<GroupTransform>\n      children:\n"
                        "        - !<BuiltinTransform> {style: UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD}\n"
                        "        - !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}\n");
    return file(name).string();
  }
};

const std::string ap0_space = "  - !<ColorSpace>\n    name: aces\n    encoding: scene-linear\n";
const std::string ap0_role = "  aces_interchange: aces\n";

std::vector<float> grey(const DisplayTransform& transform, float value) {
  std::vector<float> rgb{value, value, value};
  transform.apply(rgb);
  return rgb;
}

TEST_F(Color, DefaultIsThePlainSrgbCurve) {
  const DisplayTransform transform;
  EXPECT_NEAR(grey(transform, 0.18f)[0], 0.4614f, 5e-5f);
  std::mt19937 generator(2);
  std::uniform_real_distribution<float> value(0.0f, 1.0f);
  for (int i = 0; i < 1000; ++i) {
    std::vector<float> rgb{value(generator), value(generator), value(generator)};
    const std::vector<float> linear = rgb;
    transform.apply(rgb);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(rgb[c], srgb_encode(linear[c]), 5e-5f);
  }
}

TEST_F(Color, AcesViewHasItsKnownValues) {
  const DisplayTransform transform({.view = "ACES 1.0 - SDR Video"});
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(grey(transform, 0.18f)[c], 0.3560f, 1e-4f);
    EXPECT_NEAR(grey(transform, 1.0f)[c], 0.8120f, 1e-4f);
  }
}

TEST_F(Color, Rec1886IsAGammaOf2Point4) {
  const DisplayTransform transform({.display = "Rec.1886 Rec.709 - Display"});
  EXPECT_NEAR(grey(transform, 0.18f)[0], std::pow(0.18f, 1.0f / 2.4f), 1e-4f);
  EXPECT_EQ(transform.view(), "Un-tone-mapped");
}

TEST_F(Color, ExposureMultipliesByPowersOfTwo) {
  const DisplayTransform plain, brighter({.exposure_stops = 2.0f});
  EXPECT_NEAR(grey(brighter, 0.1f)[0], grey(plain, 0.4f)[0], 1e-5f);
  EXPECT_THROW(DisplayTransform({.exposure_stops = NAN}), Error);
  EXPECT_THROW(DisplayTransform({.exposure_stops = 1e6f}), Error);
}

TEST_F(Color, AnythingBecomesFiniteInZeroToOne) {
  for (const char* view : {"Un-tone-mapped", "ACES 1.0 - SDR Video"})
    for (const float stops : {-100.0f, 0.0f, 100.0f}) {
      const DisplayTransform transform({.view = view, .exposure_stops = stops});
      std::vector<float> rgb{NAN,  0.5f, 0.5f,     INFINITY,  1e30f,  -1e30f,
                             0.0f, 0.0f, 65504.0f, -INFINITY, 1e-40f, 100.0f};
      transform.apply(rgb);
      for (const float v : rgb) EXPECT_TRUE(v >= 0.0f && v <= 1.0f) << v;
    }
}

TEST_F(Color, ANaNChannelDoesNotTakeItsNeighboursAlong) {
  const DisplayTransform transform({.view = "ACES 1.0 - SDR Video"});
  std::vector<float> rgb{NAN, 0.5f, 0.5f};
  transform.apply(rgb);
  EXPECT_GT(rgb[1], 0.3f);
}

TEST_F(Color, UnknownNamesListTheKnownOnes) {
  const std::string display = error_of([] { DisplayTransform({.display = "TV"}); });
  EXPECT_TRUE(contains(display, "'TV'") && contains(display, "sRGB - Display, Rec.1886 Rec.709 - Display"))
      << display;
  const std::string view = error_of([] { DisplayTransform({.view = "Filmic"}); });
  EXPECT_TRUE(contains(view, "Un-tone-mapped, ACES 1.0 - SDR Video")) << view;
}

TEST_F(Color, OptionBeforeEnvironmentBeforeBuiltIn) {
  const std::string a = write_config("a.ocio", "from option", ap0_role, ap0_space);
  const std::string b = write_config("b.ocio", "from environment", ap0_role, ap0_space);
  EXPECT_EQ(DisplayTransform().view(), "Un-tone-mapped");
  ::setenv("OCIO", b.c_str(), 1);
  EXPECT_EQ(DisplayTransform().view(), "from environment");
  EXPECT_EQ(DisplayTransform({.config = a}).view(), "from option");
  ::setenv("OCIO", "", 1);
  EXPECT_EQ(DisplayTransform().view(), "Un-tone-mapped");
}

TEST_F(Color, AnUnreadableConfigIsNeverReplaced) {
  EXPECT_TRUE(contains(error_of([&] { DisplayTransform({.config = file("none.ocio").string()}); }), "--ocio"));
  ::setenv("OCIO", file("none.ocio").c_str(), 1);
  EXPECT_TRUE(contains(error_of([] { DisplayTransform(); }), "$OCIO"));
  put(file("bad.ocio"), "ocio_profile_version: 2\ncolorspaces: 7\n");
  EXPECT_THROW(DisplayTransform({.config = file("bad.ocio").string()}), Error);
}

// The same display reached through the role's ACES2065-1 and through a named Rec.709 space gives the same
// values.
TEST_F(Color, Rec709IsFoundByNameOrThroughTheRole) {
  const std::string rec709 =
      ap0_space +
      "  - !<ColorSpace>\n    name: Utility - Linear - sRGB\n    encoding: scene-linear\n"
      "    to_scene_reference: !<GroupTransform>\n      children:\n"
      "        - !<BuiltinTransform> {style: UTILITY - ACES-AP1_to_LINEAR-REC709_BFD, direction: inverse}\n"
      "        - !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}\n";
  const DisplayTransform by_role({.config = write_config("role.ocio", "v", ap0_role, ap0_space)});
  const DisplayTransform by_name({.config = write_config("name.ocio", "v", "", rec709)});
  std::vector<float> a{0.8f, 0.3f, 0.05f}, b = a;
  by_role.apply(a);
  by_name.apply(b);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-5f);
  EXPECT_NEAR(a[0], srgb_encode(0.8f), 5e-5f);
}

TEST_F(Color, AConfigThatDoesNotKnowRec709IsAnErrorNamingTheRole) {
  const std::string config = write_config("none.ocio", "v", "", ap0_space);
  EXPECT_TRUE(contains(error_of([&] { DisplayTransform({.config = config}); }), "aces_interchange"));
}

TEST_F(Color, DescriptionTellsAll) {
  const std::string text = DisplayTransform({.exposure_stops = 1.5f}).description();
  for (const char* part : {"built-in", "sRGB - Display", "Un-tone-mapped", "1.5"})
    EXPECT_TRUE(contains(text, part)) << text;
}

void expect_near(const C3f& a, const C3f& b, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance);
}

// Rec.709 to AP1 with Bradford's adaptation, as the ACES configurations have it.
TEST_F(Color, WorkingSpacesAreMatrices) {
  const WorkingSpace acescg = find_working_space("ACEScg", "");
  EXPECT_EQ(acescg.interop_id, "lin_ap1_scene");
  EXPECT_FALSE(acescg.is_rec709());
  expect_near(acescg.from_rec709(C3f(1, 0, 0)), C3f(0.613097f, 0.070194f, 0.020616f), 1e-5f);
  expect_near(acescg.from_rec709(C3f(0, 1, 0)), C3f(0.339523f, 0.916354f, 0.109570f), 1e-5f);
  expect_near(acescg.from_rec709(C3f(0, 0, 1)), C3f(0.047380f, 0.013452f, 0.869815f), 1e-5f);
  expect_near(acescg.to_rec709(acescg.from_rec709(C3f(0.7f, 0.2f, 0.05f))), C3f(0.7f, 0.2f, 0.05f), 1e-5f);
  EXPECT_EQ(find_working_space("ACES2065-1", "").interop_id, "lin_ap0_scene");
  for (const char* name : {"", "scene_linear", "lin_rec709_scene"}) {
    const WorkingSpace rec709 = find_working_space(name, "");
    EXPECT_TRUE(rec709.is_rec709()) << name;
    expect_near(rec709.from_rec709(C3f(0.3f, 0.6f, 0.9f)), C3f(0.3f, 0.6f, 0.9f), 1e-5f);
  }
}

// Names and primaries by the recommendation; the library's own matrices are the judge.
TEST_F(Color, NamedSpacesHaveThePrimariesOfTheirNames) {
  for (const auto& [name, primaries] : interop_spaces()) {
    const ColorMatrix from_rec709 = conversion(*find_interop_space(rec709_id), primaries);
    EXPECT_EQ(interop_id_of(from_rec709), name);
    const Primaries seen = primaries_of(conversion(primaries, *find_interop_space(rec709_id)));
    // Under Rec.709's white: the same, where that is the space's own.
    if (primaries.white == find_interop_space(rec709_id)->white) {
      for (const auto& [a, b] :
           {std::pair(seen.red, primaries.red), {seen.green, primaries.green}, {seen.blue, primaries.blue}})
        EXPECT_LT((a - b).length(), 1e-5f) << name;
    }
    EXPECT_LT((seen.white - V2f(0.3127f, 0.3290f)).length(), 1e-5f) << name;
  }
  for (const std::string name : {"ACEScg", "ACES2065-1"}) {
    const WorkingSpace space = find_working_space(name, "");
    const ColorMatrix ours = conversion(*find_interop_space(rec709_id), *find_interop_space(space.interop_id));
    for (std::size_t i = 0; i < 3; ++i) expect_near(ours.image[i], space.from_rec709.image[i], 1e-5f);
  }
  EXPECT_EQ(interop_id_of({{C3f(1, 0, 0), C3f(0, 1, 0), C3f(0, 0.1f, 0.9f)}}), "");
}

TEST_F(Color, RolesNameSpacesToo) {
  EXPECT_EQ(find_working_space("aces_interchange", "").name, "ACES2065-1");
  EXPECT_EQ(find_working_space("lin_ap1_scene", "").name, "ACEScg") << "an alias";
  EXPECT_TRUE(contains(error_of([] { (void)find_working_space("Raw", ""); }), "data"));
  EXPECT_TRUE(contains(
      error_of([&] { (void)find_working_space("aces", write_config("norole.ocio", "v", "", ap0_space)); }),
      "aces_interchange"));
}

TEST_F(Color, WorkingSpacesMustBeLinearAndKnown) {
  EXPECT_TRUE(contains(error_of([] { (void)find_working_space("sRGB - Texture", ""); }), "not linear"));
  const std::string unknown = error_of([] { (void)find_working_space("ACEScq", ""); });
  EXPECT_TRUE(contains(unknown, "--working-space")) << unknown;
  EXPECT_TRUE(contains(unknown, "ACEScg")) << unknown;
}

TEST_F(Color, DisplaysShowTheSameColourFromAnyWorkingSpace) {
  const C3f color(0.8f, 0.3f, 0.05f), in_acescg = find_working_space("ACEScg", "").from_rec709(color);
  for (const char* view : {"Un-tone-mapped", "ACES 1.0 - SDR Video"}) {
    std::vector<float> a{color.x, color.y, color.z}, b{in_acescg.x, in_acescg.y, in_acescg.z};
    DisplayTransform({.view = view}).apply(a);
    DisplayTransform({.view = view, .working_space = "ACEScg"}).apply(b);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-4f) << view;
  }
}

TEST_F(Color, LooksComeBeforeTheView) {
  const std::string look =
      "looks:\n  - !<Look>\n    name: square\n    process_space: aces\n"
      "    transform: !<ExponentTransform> {value: [2, 2, 2, 1]}\n";
  std::string config = write_config("look.ocio", "v", ap0_role, ap0_space);
  put(file("look.ocio"), content_of(file("look.ocio")) + look);
  const float plain = grey(DisplayTransform({.config = config}), 0.25f)[0];
  const float looked = grey(DisplayTransform({.config = config, .look = "square"}), 0.5f)[0];
  EXPECT_NEAR(plain, looked, 1e-4f);
  const std::string error = error_of([&] { DisplayTransform({.config = config, .look = "cube"}); });
  EXPECT_TRUE(contains(error, "square")) << error;
}

}  // namespace
}  // namespace twopass
