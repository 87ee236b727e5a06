#include "render/load/mitsuba_clip.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class MitsubaClip : public LoadTest {
 protected:
  /// Loads a shape in front of a camera at the origin that looks along +z, sees from 1 to 10, and notes what it
  /// cuts.
  LoadedScene read(const std::string& shape) const {
    return load_xml(
        "<scene version='3.0.0'><sensor type='perspective'><float name='near_clip' value='1'/>"
        "<float name='far_clip' value='10'/></sensor>" +
        shape + "</scene>");
  }
  LoadedScene rectangle_at(const std::string& place) const {
    return read("<shape type='rectangle'><transform name='to_world'><translate " + place +
                "/></transform></shape>");
  }
  LoadedScene sphere_at(const std::string& center) const {
    return read("<shape type='sphere'><point name='center' value='" + center + "'/></shape>");
  }
};

TEST_F(MitsubaClip, NothingIsNotedBetweenThePlanes) {
  EXPECT_TRUE(rectangle_at("z='5'").notes.empty());
  EXPECT_TRUE(rectangle_at("z='1.01'").notes.empty());
  EXPECT_TRUE(rectangle_at("x='2.01' z='0.01'").notes.empty());  // beside the camera, a unit away
  EXPECT_TRUE(sphere_at("0 0 5").notes.empty());
}

TEST_F(MitsubaClip, NothingIsNotedBehindTheCamera) {
  EXPECT_TRUE(rectangle_at("z='-0.5'").notes.empty());
  EXPECT_TRUE(sphere_at("0 0 -50").notes.empty());
}

TEST_F(MitsubaClip, NearSurfacesAreNoted) {
  for (const char* place : {"z='0.9'", "x='1.9' z='0.1'", "x='1.5' y='1.5' z='0.5'"})
    EXPECT_TRUE(has_note(rectangle_at(place), "near_clip is not applied")) << place;
  EXPECT_TRUE(has_note(sphere_at("0 0 1.9"), "near_clip is not applied"));
  EXPECT_TRUE(has_note(sphere_at("0 0 0.5"), "near_clip is not applied"));  // from inside
}

TEST_F(MitsubaClip, FarSurfacesAreNoted) {
  EXPECT_TRUE(has_note(rectangle_at("z='20'"), "far_clip is not applied"));
  EXPECT_TRUE(has_note(sphere_at("0 0 9.5"), "far_clip is not applied"));
}

}  // namespace
}  // namespace twopass
