#include "render/load/ies_file.h"

#include "render/scene/punctual_light.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

/// A file of one half-plane, with `body` from the line of counts on.
std::string with_head(const std::string& body) {
  return "IESNA:LM-63-2002\n[TEST] 1\n[MANUFAC] nobody\nTILT=NONE\n" + body;
}

constexpr const char* simple = "1 1000 2.0 3 1 1 2 0 0 0\n1.0 1.0 100\n0 45 90\n0\n100 50 0\n";

TEST(IesFile, ReadsAllEditions) {
  for (const std::string head :
       {"IESNA:LM-63-2002\n[TEST] x\n", "IESNA:LM-63-1995\n[TEST] x\n", "IESNA91\n[TEST] x\n",
        "a lamp of 1986, no keywords\n", "\xEF\xBB\xBFIESNA91\r\n"}) {
    const IesProfile profile = parse_ies(head + "TILT=NONE\r\n" + simple, "a.ies");
    EXPECT_EQ(profile.vertical(), (std::vector<float>{0, 45, 90}));
    EXPECT_EQ(profile.horizontal(), std::vector<float>{0});
    EXPECT_EQ(profile.values(), (std::vector<float>{200, 100, 0}));  // times the multiplier
    EXPECT_EQ(profile.maximum(), 200.0f);
  }
}

TEST(IesFile, NumbersMayBreakAnywhere) {
  const IesProfile profile =
      parse_ies(with_head("1 -1 1\n2 3 1 2 0,0,0 0.5\n0.8 50\n0 90 0 90\n180 10 20 30\n40 50\n60"), "a.ies");
  EXPECT_EQ(profile.values(), (std::vector<float>{4, 8, 12, 16, 20, 24}));
}

TEST(IesFile, TiltOfOneIsNoTilt) {
  const auto read = [](const std::string& factors) {
    return parse_ies("IESNA91\nTILT=INCLUDE\n1\n3\n0 45 90\n" + factors + "\n" + simple, "a.ies");
  };
  EXPECT_EQ(read("1 1 1").maximum(), 200.0f);
  expect_error([&] { read("1 .9 .8"); },
               {"a.ies:6: the lamp's light depends on the luminaire's tilt", "TILT=NONE"});
  expect_error([&] { parse_ies("IESNA91\nTILT=lamp.tlt\n", "a.ies"); },
               {"a.ies:2: TILT=lamp.tlt is not supported"});
}

TEST(IesFile, HostileFiles) {
  const auto expect = [](const std::string& text, std::initializer_list<std::string_view> parts) {
    expect_error([&] { parse_ies(text, "a.ies"); }, parts);
  };
  expect("", {"a.ies: no line TILT="});
  expect("<html>", {"a.ies: no line TILT="});
  expect(with_head(""), {"a.ies:4: the file ends before the number of lamps", "incomplete"});
  expect(with_head("1 1000 1 3 1 1 2 0 0 0\n1 1 100\n0 45 90\n0\n100 50"), {"ends before the candela values"});
  expect(with_head("1 1000 nan 3 1 1"), {"a.ies:5: the candela multiplier: 'nan' is not a finite number"});
  expect(with_head("1 1000 1e999 3 1 1"), {"is not a finite number"});
  expect(with_head("1 1000 1 -3 1 1"), {"a.ies:5: the number of vertical angles is not a whole number"});
  expect(with_head("1 1000 1 2.5 1 1"), {"not a whole number"});
  expect(with_head("1 1000 1 3 4000000000 1"), {"the number of horizontal angles is not a whole number"});
  expect(with_head("1 1000 1 20000 20000 1 2 0 0 0\n1 1 1\n"),
         {"more candela values are announced than the file can hold"});
  expect(with_head("1 1000 1 3 1 2 2 0 0 0\n"), {"only photometric type C (1)", "convert"});
  expect(with_head("1 1000 1 3 1 7 2 0 0 0\n"), {"only photometric type C (1)", "correct the type"});
  expect(with_head("1 1000 1 3 1 1 2 0 0 0\n1 1 100\n0 90 45\n0\n1 1 1"),
         {"a.ies:7: the vertical angles do not ascend"});
  expect(with_head("1 1000 1 3 1 1 2 0 0 0\n1 1 100\n0 45 45\n0\n1 1 1"), {"do not ascend"});
  expect(with_head("1 1000 1 3 1 1 2 0 0 0\n1 1 100\n0 45 190\n0\n1 1 1"), {"outside of 0 to 180 degrees"});
  expect(with_head("1 1000 1 3 2 1 2 0 0 0\n1 1 100\n0 45 90\n0 100\n1 1 1 1 1 1"),
         {"the horizontal angles do not run from 0"});
  expect(with_head("1 1000 -1 3 1 1 2 0 0 0\n1 1 100\n0 45 90\n0\n1 1 1"), {"negative or huge"});
  // A little less than nothing is the noise of a measurement.
  EXPECT_EQ(
      parse_ies(with_head("1 1000 1 3 1 1 2 0 0 0\n1 1 100\n0 45 90\n0\n100 50 -0.5"), "a.ies").values()[2],
      0.0f);
}

TEST(IesFile, Cie171PointSource) {
  // CIE 171:2006, 5.2: a Lambertian point of 1000 cd at a height of 3 m lights the floor with I0 cos^4 / h^2.
  std::string text = with_head("1 -1 1 91 1 1 2 0 0 0\n1 1 100\n");
  for (int gamma = 0; gamma <= 90; ++gamma) text += std::to_string(gamma) + "\n";
  text += "0\n";
  for (int gamma = 0; gamma <= 90; ++gamma)
    text += std::to_string(1000.0 * std::cos(gamma * pi / 180.0)) + "\n";
  PointLight lamp{
      V3f(0, 0, 3), C3f(1.0f), std::make_shared<const IesProfile>(parse_ies(text, "lambert.ies")), {}};
  EXPECT_NEAR(power(lamp, 1.0), 1000.0 * pi, 0.1);
  M44d down;
  down[1][1] = down[2][2] = -1.0;
  lamp.frame = light_frame(down);
  for (const auto& [x, lux] : {std::pair{0.0f, 111.1111f}, {0.5f, 105.1863f}, {1.0f, 90.0f}}) {
    const Illumination there = illumination(lamp, V3f(x, 0, 0));
    EXPECT_NEAR(there.irradiance.x * there.direction.z, lux, lux * 5e-5f) << x;
  }
}

}  // namespace
}  // namespace twopass
