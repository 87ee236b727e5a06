#include "render/load/mitsuba_references.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class MitsubaReferences : public LoadTest {
 protected:
  LoadedScene read(const std::string& body) const {
    return load_xml("<scene version='3.0.0'>\n" + body + "\n</scene>");
  }
};

TEST_F(MitsubaReferences, CirclesAreErrors) {
  expect_error([&] { read("<bsdf type='twosided' id='a'><ref id='a'/></bsdf>"); },
               {"scene.xml:2: this <bsdf> refers to itself"});
  expect_error(
      [&] {
        read(
            "<bsdf type='twosided' id='a'><ref id='b'/></bsdf>\n"
            "<bsdf type='mask' id='b'><ref id='a'/></bsdf>");
      },
      {"scene.xml:2: this <bsdf> refers to itself; break the circle"});
  expect_error([&] { read("<shape type='sphere' id='a'><ref id='a'/></shape>"); }, {"refers to itself"});
  expect_error([&] { read("<texture type='checkerboard' id='a'><ref name='color0' id='a'/></texture>"); },
               {"refers to itself"});
}

TEST_F(MitsubaReferences, SharingIsNoCircle) {
  EXPECT_EQ(read("<bsdf type='diffuse' id='a'/><bsdf type='twosided' id='b'><ref id='a'/><ref id='a'/></bsdf>"
                 "<shape type='sphere'><ref id='b'/></shape><shape type='cube'><ref id='b'/></shape>")
                .scene.shapes.size(),
            2u);
}

// Thirty lines that would be 2^30 materials.
TEST_F(MitsubaReferences, GrowthByReferencesIsBounded) {
  std::string body = "<bsdf type='diffuse' id='b0'/>\n";
  for (int i = 1; i <= 30; ++i) {
    const std::string inner = "<ref id='b" + std::to_string(i - 1) + "'/>";
    body += "<bsdf type='blendbsdf' id='b" + std::to_string(i) + "'><float name='weight' value='.5'/>" + inner +
            inner + "</bsdf>\n";
  }
  expect_error([&] { read(body); }, {"this <bsdf> holds more than 10000 objects by its references"});
}

TEST_F(MitsubaReferences, DepthByReferencesIsBounded) {
  std::string body;
  for (int i = 0; i < 200; ++i)
    body +=
        "<bsdf type='mask' id='b" + std::to_string(i) + "'><ref id='b" + std::to_string(i + 1) + "'/></bsdf>\n";
  body += "<bsdf type='diffuse' id='b200'/>";
  expect_error([&] { read(body); }, {"nested more than 100 deep by references"});
}

}  // namespace
}  // namespace twopass
