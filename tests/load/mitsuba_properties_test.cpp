#include "render/load/mitsuba_properties.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

/// The properties of the first object of a scene.
class MitsubaPropertiesTest : public LoadTest {
 protected:
  Properties& open(const std::string& body) {
    tree_ = read_mitsuba(write("scene.xml", "<scene version='3.0.0'>\n" + body + "\n</scene>"), {});
    properties_.emplace(tree_.root.children.at(0), tree_);
    return *properties_;
  }
  MitsubaTree tree_;
  std::optional<Properties> properties_;
};

TEST_F(MitsubaPropertiesTest, ReadsEveryType) {
  Properties& p = open(
      "<shape type='x' id='me'><float name='f' value='1.5'/><integer name='i' value='3'/>"
      "<boolean name='b' value='true'/><string name='s' value='text'/><point name='p' value='1 2 3'/>"
      "<rgb name='c' value='0.5'/><transform name='t'><scale value='2'/></transform></shape>");
  EXPECT_EQ(p.type(), "x");
  EXPECT_EQ(p.id_or("none"), "me");
  EXPECT_EQ(p.number("f"), 1.5);
  EXPECT_EQ(p.number("i"), 3.0);
  EXPECT_EQ(p.integer("i"), 3);
  EXPECT_TRUE(p.boolean("b", false));
  EXPECT_EQ(p.text("s"), "text");
  EXPECT_EQ(p.point("p", V3d(0.0)), V3d(1, 2, 3));
  EXPECT_EQ(p.color("c", ColorUse::reflectance), C3f(0.5f));
  EXPECT_EQ(p.transform("t")[0][0], 2.0);
  p.finish();
}

TEST_F(MitsubaPropertiesTest, AbsentPropertiesHaveDefaults) {
  Properties& p = open("<shape type='x'/>");
  EXPECT_FALSE(p.number("f"));
  EXPECT_FALSE(p.text("s"));
  EXPECT_TRUE(p.boolean("b", true));
  EXPECT_EQ(p.point("p", V3d(7.0)), V3d(7.0));
  EXPECT_EQ(p.transform("t"), M44d());
  EXPECT_EQ(p.id_or("none"), "none");
  p.finish();
}

TEST_F(MitsubaPropertiesTest, UnreadPropertiesListWhatThereIs) {
  Properties& p =
      open("<shape type='x'>\n<float name='radius' value='1'/>\n<float name='raduis' value='1'/></shape>");
  p.number("radius");
  p.boolean("flip_normals", false);
  expect_error([&] { p.finish(); },
               {"scene.xml:4: shape 'x' has no property 'raduis'; its properties: radius, flip_normals"});
  p.ignore({"raduis"});
  EXPECT_NO_THROW(p.finish());
}

TEST_F(MitsubaPropertiesTest, UnreadObjectsListWhatThereIs) {
  Properties& p = open("<shape type='x'>\n<medium type='homogeneous'/></shape>");
  p.objects("bsdf");
  expect_error([&] { p.finish(); },
               {"scene.xml:3: a <medium> inside shape 'x' is not supported; it takes: bsdf"});
}

TEST_F(MitsubaPropertiesTest, WrongTypesAreErrors) {
  Properties& p = open("<shape type='x'>\n<string name='f' value='1'/><float name='i' value='1'/></shape>");
  expect_error([&] { p.number("f"); }, {"scene.xml:3: property 'f' cannot be a <string>; use: float, integer"});
  expect_error([&] { p.integer("i"); }, {"property 'i' cannot be a <float>"});
}

TEST_F(MitsubaPropertiesTest, PropertiesAreGivenOnceAndNamed) {
  expect_error([&] { open("<shape type='x'><float name='f' value='1'/>\n<rgb name='f' value='1'/></shape>"); },
               {"scene.xml:3: property 'f' is given twice"});
  expect_error([&] { open("<shape type='x'><float value='1'/></shape>"); }, {"<float> has no name"});
  expect_error([&] { open("<shape id='x'/>"); }, {"scene.xml:2: <shape> has no attribute 'type'"});
  expect_error([&] { open("<shape typ='x'/>"); }, {"does not know the attribute 'typ'"});
  expect_error([&] { open("<shape type='x'><integer name='i' value='9999999999'/></shape>").integer("i"); },
               {"'i' is out of range"});
}

TEST_F(MitsubaPropertiesTest, ObjectsMayBeNestedOrReferenced) {
  Properties& p = open(
      "<shape type='x'><bsdf type='a'/><ref id='later'/><ref name='named' id='later'/></shape>"
      "<bsdf type='b' id='later'/>");
  const std::vector<const XmlNode*> found = p.objects("bsdf");
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0]->get("type"), "a");
  EXPECT_EQ(found[1], &tree_.root.children[1]);
  EXPECT_EQ(found[2], found[1]);
  expect_error([&] { p.object_of("bsdf"); }, {"a second <bsdf> in shape 'x'"});
  p.finish();
}

TEST_F(MitsubaPropertiesTest, ColoursMayBeSpectrumObjects) {
  Properties& p = open(
      "<emitter type='x'><spectrum type='d65' name='a'><float name='scale' value='3'/></spectrum>"
      "<spectrum type='uniform' name='b'><float name='value' value='0.5'/></spectrum>"
      "<spectrum type='srgb' name='c'><rgb name='color' value='1 2 3'/></spectrum>"
      "<spectrum type='blackbody' name='d'/></emitter>");
  EXPECT_EQ(p.color("a", ColorUse::emission), C3f(3.0f));
  EXPECT_EQ(p.color("b", ColorUse::emission), C3f(0.5f));
  EXPECT_EQ(p.color("c", ColorUse::emission), C3f(1, 2, 3));
  expect_error([&] { p.color("d", ColorUse::emission); },
               {"spectrum 'blackbody' is not supported; supported spectrums: d65, srgb, uniform"});
}

TEST_F(MitsubaPropertiesTest, SpectrumObjectsCannotReferToThemselves) {
  Properties& p = open(
      "<emitter type='x'><ref name='a' id='s'/></emitter>"
      "<spectrum type='d65' id='s'><ref name='color' id='s'/></spectrum>");
  expect_error([&] { p.color("a", ColorUse::emission); }, {"property 'color' cannot be a <spectrum>"});
}

TEST_F(MitsubaPropertiesTest, TexturesAreRefusedByName) {
  Properties& p = open(
      "<bsdf type='x'>\n<texture type='bitmap' name='a'><string name='filename' value='f'/></texture></bsdf>");
  expect_error([&] { p.color("a", ColorUse::reflectance); },
               {"scene.xml:3: texture 'bitmap' is not supported; give a colour"});
}

TEST_F(MitsubaPropertiesTest, UnsupportedPluginsListTheSupported) {
  constexpr Named<int> table[] = {{"hdrfilm", 1}, {"other", 2}};
  EXPECT_EQ(plugin_of_type<int>(table, open("<film type='other'/>").object()), 2);
  expect_error([&] { plugin_of_type<int>(table, open("<film type='foo'/>").object()); },
               {"scene.xml:2: film 'foo' is not supported; supported films: hdrfilm, other"});
  expect_error([&] { plugin_of_type<int>(table, open("<film type='ldrfilm'/>").object()); },
               {"it was renamed: use hdrfilm"});
}

}  // namespace
}  // namespace twopass
