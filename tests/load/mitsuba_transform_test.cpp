#include "render/load/mitsuba_transform.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class MitsubaTransform : public LoadTest {
 protected:
  M44d parse(const std::string& steps) const {
    return parse_transform(read_xml(write("t.xml", "<transform name='to_world'>\n" + steps + "</transform>")));
  }
  V3f apply(const std::string& steps, const V3d& p) const {
    V3d result;
    parse(steps).multVecMatrix(p, result);
    return V3f(result);
  }
};

TEST_F(MitsubaTransform, NoStepsAreTheIdentity) { EXPECT_EQ(parse(""), M44d()); }

TEST_F(MitsubaTransform, Translate) {
  expect_near(apply("<translate x='1' z='3'/>", {1, 1, 1}), {2, 1, 4});
  expect_near(apply("<translate value='1, 2, 3'/>", {0, 0, 0}), {1, 2, 3});
}

TEST_F(MitsubaTransform, Scale) {
  expect_near(apply("<scale x='2'/>", {1, 1, 1}), {2, 1, 1});  // missing components are 1
  expect_near(apply("<scale value='3'/>", {1, 1, 1}), {3, 3, 3});
  expect_near(apply("<scale value='1 2 3'/>", {1, 1, 1}), {1, 2, 3});
}

TEST_F(MitsubaTransform, RotateIsCounterClockwiseInDegrees) {
  expect_near(apply("<rotate z='1' angle='90'/>", {1, 0, 0}), {0, 1, 0});
  expect_near(apply("<rotate x='1' angle='90'/>", {0, 1, 0}), {0, 0, 1});
  expect_near(apply("<rotate y='2' angle='90'/>", {0, 0, 1}), {1, 0, 0});
  expect_near(apply("<rotate value='1, 1, 1' angle='120'/>", {1, 0, 0}), {0, 1, 0});
  expect_error([&] { parse("<rotate angle='90'/>"); }, {"t.xml:2: <rotate> has no axis"});
  expect_error([&] { parse("<rotate x='1'/>"); }, {"t.xml:2: <rotate> has no attribute 'angle'"});
}

TEST_F(MitsubaTransform, StepsApplyInTheirOrder) {
  expect_near(apply("<scale value='2'/><translate x='1'/>", {1, 0, 0}), {3, 0, 0});
  expect_near(apply("<translate x='1'/><scale value='2'/>", {1, 0, 0}), {4, 0, 0});
  expect_near(apply("<translate x='1'/><rotate z='1' angle='90'/><translate x='5'/>", {0, 0, 0}), {5, 1, 0});
}

TEST_F(MitsubaTransform, MatricesAreWrittenRowByRow) {
  expect_near(apply("<matrix value='0 -1 0 10  1 0 0 20  0 0 1 30  0 0 0 1'/>", {1, 0, 0}), {10, 21, 30});
  expect_near(apply("<matrix value='0 -1 0  1 0 0  0 0 1'/>", {1, 0, 0}), {0, 1, 0});
  expect_error([&] { parse("<matrix value='1 2 3'/>"); }, {"<matrix> has 3 numbers; give 16 or 9"});
  expect_error([&] { parse("<matrix value='1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1'/>"); }, {"<matrix> is not affine"});
}

TEST_F(MitsubaTransform, LookAtMapsTheCameraFrame) {
  for (const char* tag : {"lookat", "lookAt"}) {
    const std::string step = std::string("<") + tag + " origin='1, 2, 3' target='1, 2, 13' up='0, 1, 0'/>";
    expect_near(apply(step, {0, 0, 0}), {1, 2, 3});
    expect_near(apply(step, {0, 0, 1}), {1, 2, 4});  // +z is forward
    expect_near(apply(step, {0, 1, 0}), {1, 3, 3});  // +y is up
    expect_near(apply(step, {1, 0, 0}), {2, 2, 3});  // +x completes a right-handed frame: left of the picture
  }
  expect_error([&] { parse("<lookat origin='0 0 0' target='0 0 0' up='0 1 0'/>"); }, {"t.xml:2: ", "coincide"});
  expect_error([&] { parse("<lookat origin='0 0 0' target='0 1 0' up='0 1 0'/>"); }, {"t.xml:2: ", "parallel"});
  expect_error([&] { parse("<lookat origin='0 0' target='0 1 0'/>"); }, {"'origin' needs three numbers"});
}

TEST_F(MitsubaTransform, LookAtWithoutUpChoosesOne) {
  for (const char* target : {"1 0 0", "0 1 0", "0 0 1", "1 1 1"}) {
    const M44d m = parse(std::string("<lookat origin='0 0 0' target='") + target + "'/>");
    EXPECT_NEAR(m.determinant(), 1.0, 1e-12) << target;
  }
}

TEST_F(MitsubaTransform, RefusesUnknownSteps) {
  expect_error([&] { parse("<shear x='1'/>"); },
               {"t.xml:2: unknown transform step <shear>", "translate, scale, rotate, lookat, matrix"});
  expect_error([&] { parse("<scale w='1'/>"); }, {"does not know the attribute 'w'"});
  expect_error([&] { parse("<scale value='1e200'/><scale value='1e200'/>"); }, {"the transform is not finite"});
}

}  // namespace
}  // namespace twopass
