#include "render/load/mitsuba_values.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class MitsubaValues : public LoadTest {
 protected:
  XmlNode node(const std::string& text) const { return read_xml(write("v.xml", text)); }
  C3f color(const std::string& text, ColorUse use = ColorUse::reflectance) const {
    return parse_color(node(text), use, notes_);
  }
  mutable Notes notes_;
};

TEST_F(MitsubaValues, VectorsInBothNotations) {
  EXPECT_EQ(parse_vector(node("<point name='p' value='1, 2 3'/>")), V3d(1, 2, 3));
  EXPECT_EQ(parse_vector(node("<point name='p' value='4'/>")), V3d(4.0));
  EXPECT_EQ(parse_vector(node("<vector name='p' x='1' y='-2' z='.5'/>")), V3d(1, -2, 0.5));
  expect_error([&] { parse_vector(node("<point name='p' x='1' y='2'/>")); },
               {"v.xml:1: <point> has no attribute 'z'"});
  expect_error([&] { parse_vector(node("<point name='p' value='1 2'/>")); }, {"needs one or three numbers"});
  expect_error(
      [&] { parse_vector(node("<point name='p' valeu='1'/>")); },
      {"v.xml:1: <point> does not know the attribute 'valeu'", "its attributes: name, value, x, y, z"});
}

TEST_F(MitsubaValues, BooleansAndIntegers) {
  EXPECT_TRUE(parse_boolean(node("<boolean name='b' value='True'/>")));
  EXPECT_FALSE(parse_boolean(node("<boolean name='b' value='false'/>")));
  expect_error([&] { parse_boolean(node("<boolean name='b' value='1'/>")); },
               {"'1' is neither; write true or false"});
  EXPECT_EQ(parse_integer_value(node("<integer name='i' value=' -3 '/>")), -3);
  expect_error([&] { parse_integer_value(node("<integer name='i' value='3.5'/>")); },
               {"'3.5' is not a whole number"});
}

TEST_F(MitsubaValues, Numbers) {
  EXPECT_EQ(parse_number_attribute(node("<float value='1e-2'/>"), "value"), 0.01);
  expect_error([&] { parse_number_attribute(node("<float value='0,5'/>"), "value"); },
               {"'0,5' is not a finite number"});
  expect_error([&] { parse_number_attribute(node("<float value='nan'/>"), "value"); }, {"'nan' is not"});
  expect_error([&] { parse_number_attribute(node("<float value=''/>"), "value"); }, {"'' is not"});
}

TEST_F(MitsubaValues, RgbIsLinear) {
  EXPECT_EQ(color("<rgb name='c' value='0.1, 0.2 0.3'/>"), C3f(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(color("<rgb name='c' value='0.25'/>"), C3f(0.25f));
  EXPECT_EQ(color("<float name='c' value='0.25'/>"), C3f(0.25f));
  expect_error([&] { color("<rgb name='c' value='1 2'/>"); }, {"<rgb> has 2 numbers"});
}

TEST_F(MitsubaValues, HexadecimalAndSrgbOfOldVersions) {
  expect_near(color("<rgb name='c' value='#ff8000'/>"), {1.0f, 128.0f / 255.0f, 0.0f});
  expect_near(color("<srgb name='c' value='#ffffff'/>"), V3f(1.0f));
  // Half the code value is about a fifth of the light.
  expect_near(color("<srgb name='c' value='0.5, 0.04, 0'/>"), {0.21404f, 0.04f / 12.92f, 0.0f});
  expect_error([&] { color("<rgb name='c' value='#12345'/>"); }, {"'#12345' is not a colour"});
  expect_error([&] { color("<rgb name='c' value='#12345g'/>"); }, {"'#12345g' is not a colour"});
}

TEST_F(MitsubaValues, UniformSpectra) {
  EXPECT_EQ(color("<spectrum name='c' value='0.25'/>"), C3f(0.25f));
  EXPECT_EQ(color("<spectrum name='c' value='2.5'/>", ColorUse::index), C3f(2.5f));
  // Equal energy under a D65 white, as Mitsuba's scalar_rgb has it.
  expect_near(color("<spectrum name='c' value='1'/>", ColorUse::emission), {1.204975f, 0.948279f, 0.908624f});
}

TEST_F(MitsubaValues, SpectraOfSamples) {
  expect_near(color("<spectrum name='c' value='300:0.4, 900:0.4'/>"), V3f(0.4f), 1e-4f);
  const C3f red = color("<spectrum name='c' value='400:0.04 500:0.06 600:0.3 700:0.6'/>");
  EXPECT_GT(red.x, 2.5f * red.y);
  const C3f clamped = color("<spectrum name='c' value='640:1, 700:1'/>");
  EXPECT_GE(std::min({clamped.x, clamped.y, clamped.z}), 0.0f);
  expect_error([&] { color("<spectrum name='c' value='0.1, 0.2, 0.3'/>"); }, {"'0.1' has no wavelength"});
  expect_error([&] { color("<spectrum name='c' value='500:1, 400:1'/>"); },
               {"wavelengths do not ascend at '400:1'"});
  expect_error([&] { color("<spectrum name='c' value='500:1'/>"); }, {"fewer than two wavelengths"});
  expect_error([&] { color("<spectrum name='c' value='500:x, 600:1'/>"); }, {"'500:x' is not a finite number"});
  expect_error([&] { color("<spectrum name='c' value=''/>"); }, {"fewer than two wavelengths"});
  expect_error([&] { color("<spectrum name='c' filename='a.spd'/>"); }, {"spectra in files are not supported"});
}

TEST_F(MitsubaValues, ColoursHaveRanges) {
  EXPECT_TRUE(notes_.lines().empty());
  EXPECT_EQ(color("<rgb name='c' value='1.1 0 1'/>"), C3f(1, 0, 1));
  EXPECT_EQ(color("<float name='c' value='1e30'/>"), C3f(1.0f));
  ASSERT_EQ(notes_.lines().size(), 1u);
  EXPECT_NE(notes_.lines()[0].find("v.xml: 'c' above 1 reduced to 1 (2 times)"), std::string::npos)
      << notes_.lines()[0];
  expect_error([&] { color("<rgb name='c' value='-0.1 0 0'/>"); }, {"a negative or huge reflectance"});
  expect_error([&] { color("<rgb name='c' value='-0.1 0 0'/>", ColorUse::emission); },
               {"a negative or huge colour"});
  EXPECT_EQ(color("<rgb name='c' value='17'/>", ColorUse::emission), C3f(17.0f));
  expect_error([&] { color("<string name='c' value='x'/>"); }, {"<string> is not a colour"});
}

}  // namespace
}  // namespace twopass
