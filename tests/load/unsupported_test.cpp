#include "render/load/unsupported.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class UnsupportedTest : public LoadTest {
 protected:
  LoadedScene rest_of(const std::string& body) const {
    return load_scene(write("scene.xml", "<scene version='3.0.0'>\n" + body + "\n</scene>"), {}, {}, true);
  }
  LoadedScene all_of(const std::string& body) const {
    return load_xml("<scene version='3.0.0'>\n" + body + "\n</scene>");
  }
};

// Every plugin of Mitsuba that we lack: refused by name, with file and line, the names that would have worked,
// and what to do; left out, with a count, where that is asked for.
TEST_F(UnsupportedTest, IsRefusedByNameAndCanBeLeftOut) {
  const std::pair<const char*, const char*> objects[] = {
      {"shape", "bsplinecurve"},   {"shape", "linearcurve"},       {"shape", "hair"},
      {"shape", "sdfgrid"},        {"shape", "ellipsoids"},        {"shape", "ellipsoidsmesh"},
      {"emitter", "timed_sunsky"}, {"emitter", "directionalarea"}, {"sensor", "distant"},
      {"sensor", "batch"},         {"sensor", "radiancemeter"},    {"bsdf", "hair"},
      {"bsdf", "measured"},        {"bsdf", "measured_polarized"}, {"bsdf", "polarizer"},
      {"bsdf", "circular"},        {"bsdf", "retarder"},           {"bsdf", "pplastic"},
      {"shape", "nothing_known"}};
  for (const auto& [tag, type] : objects) {
    const std::string object =
        std::string("<") + tag + " type='" + type + "'><float name='x' value='1'/></" + tag + ">";
    const std::string name = std::string(tag) + " '" + type + "'";
    expect_error([&] { all_of(object); },
                 {"scene.xml:2: " + name + " is not supported; supported " + tag + "s: ",
                  "--ignore-unsupported renders what is left"});
    if (type != std::string_view("nothing_known")) EXPECT_NE(advice_on(tag, type), "") << name;
    const LoadedScene rest = rest_of(object + "<shape type='sphere'/>");
    EXPECT_EQ(rest.scene.shapes.size(), 1u) << name;
    ASSERT_EQ(rest.left_out.size(), 1u) << name;
    EXPECT_NE(rest.left_out[0].what.find("1 " + name + ", at "), std::string::npos) << rest.left_out[0].what;
    EXPECT_EQ(rest.left_out[0].why.find("not supported"), 0u);
  }
}

TEST_F(UnsupportedTest, OccurrencesAreCounted) {
  const LoadedScene rest = rest_of(
      "<shape type='sdfgrid'/>\n<shape type='cube'/><shape type='sdfgrid' id='a'/><shape type='linearcurve'/>"
      "<shape type='sphere'><float name='radios' value='3'/></shape>");
  EXPECT_EQ(rest.scene.shapes.size(), 2u);
  ASSERT_EQ(rest.left_out.size(), 3u);
  EXPECT_NE(rest.left_out[0].what.find("1 shape 'linearcurve', at "), std::string::npos);
  EXPECT_NE(rest.left_out[1].what.find("2 shapes 'sdfgrid', the first at "), std::string::npos);
  EXPECT_TRUE(rest.left_out[1].what.ends_with("scene.xml:2"));
  EXPECT_NE(rest.left_out[2].what.find("1 property 'radios' of shape 'sphere', at "), std::string::npos)
      << rest.left_out[2].what;
}

TEST_F(UnsupportedTest, WhatIsSupportedIsNotTouched) {
  EXPECT_TRUE(rest_of("<shape type='cube'/><emitter type='constant'/>").left_out.empty());
  // Other errors stay errors.
  expect_error([&] { rest_of("<shape type='sphere'><float name='radius' value='-1'/></shape>"); },
               {"scene.xml:2: a sphere's radius must be positive"});
}

TEST_F(UnsupportedTest, BsdfsAndTexturesBecomeGrey) {
  const LoadedScene rest = rest_of(
      "<bsdf type='twosided' id='hairy'><bsdf type='hair'/></bsdf>"
      "<shape type='sphere'><ref id='hairy'/></shape>"
      "<shape type='sphere'><bsdf type='diffuse'><texture type='volume' name='reflectance'>"
      "<volume type='gridvolume'/></texture></bsdf></shape>"
      "<shape type='sphere'><bsdf type='bumpmap'><texture type='volume'/><bsdf "
      "type='diffuse'/></bsdf></shape>");
  ASSERT_EQ(rest.scene.shapes.size(), 3u);
  for (std::size_t i = 0; i < 2; ++i) {
    const MaterialSide& side = rest.scene.materials[rest.scene.shapes[i].material].side[front];
    EXPECT_NEAR(side.traits().mean_diffuse_reflectance.x, 0.5f, 1e-6f);
  }
  EXPECT_EQ(rest.left_out.size(), 2u);
  EXPECT_NE(rest.left_out[0].why.find("grey in its place"), std::string::npos);
}

// Media are named by what they are, not by the property that holds them.
TEST_F(UnsupportedTest, Media) {
  const std::string inside =
      "<shape type='sphere'>\n<medium name='interior' type='homogeneous'><phase type='hg'/></medium></shape>";
  const std::string referred =
      "<medium type='homogeneous' id='fog'/>\n<shape type='sphere'><ref name='exterior' id='fog'/></shape>";
  expect_error([&] { all_of(inside); },
               {"scene.xml:3: a <medium> inside shape 'sphere' is not supported", "leave the medium out"});
  expect_error([&] { all_of(referred); }, {"scene.xml:2: <medium> is not supported"});
  for (const std::string& body : {inside, referred}) {
    const LoadedScene rest = rest_of(body);
    EXPECT_EQ(rest.scene.shapes.size(), 1u);
    ASSERT_EQ(rest.left_out.size(), 1u);
    EXPECT_NE(rest.left_out[0].what.find("1 medium 'homogeneous'"), std::string::npos) << rest.left_out[0].what;
  }
}

TEST_F(UnsupportedTest, FilmsFiltersAndSensorsFallBackToTheirDefaults) {
  const LoadedScene rest = rest_of(
      "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='9'/><rfilter "
      "type='sinc'/></film>"
      "</sensor>");
  EXPECT_EQ(rest.settings.width, 9);
  EXPECT_EQ(rest.settings.filter.kind, FilterKind::gaussian);
  EXPECT_FALSE(rest_of("<sensor type='batch'/>").scene.camera);
}

TEST_F(UnsupportedTest, ReferencesToWhatIsLeftOutGoWithIt) {
  const LoadedScene rest = rest_of(
      "<texture type='volume' id='t'/><alias id='m' as='n'/><medium type='homogeneous' id='m'/>"
      "<shape type='sphere'><ref name='interior' id='m'/><bsdf type='diffuse'><ref name='reflectance' "
      "id='t'/></bsdf>"
      "</shape>");
  EXPECT_EQ(rest.scene.shapes.size(), 1u);
}

}  // namespace
}  // namespace twopass
