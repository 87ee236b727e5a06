// Scenes that break renderers, through every integrator, solver and form factor method. All have one answer, so
// that finding light twice, losing it, and NaN show alike.
#include <gtest/gtest.h>

#include "tests/stress/furnace_scenes.h"
#include "tests/stress/picture.h"

namespace twopass::stress {
namespace {

// What must come out where everything is as bright. `path` and `unbiased` are exact; `direct` lacks what is
// reflected twice; `twopass` has the bias of 150 elements, the bare solution all of their error, and that of
// visibility from single points where faces cut each other.
void expect_furnace(const Picture& picture, const Way& way) {
  ASSERT_EQ(fault_of(picture), "");
  const double noise = 4.4 * picture.error + 1e-4;  // level 1e-5
  double below = 0.0, above = 0.0;
  if (way.integrator == IntegratorKind::direct) below = 1.0;
  if (way.integrator == IntegratorKind::two_pass) below = above = 0.03;
  if (way.integrator == IntegratorKind::radiosity) below = above = 0.35;
  EXPECT_GT(picture.mean, 1.0 - below - noise);
  EXPECT_LT(picture.mean, 1.0 + above + noise);
  EXPECT_LT(picture.cpu_seconds, 10.0 * patience);
}

void expect_furnace(const SceneDescription& scene, const std::vector<Way>& ways,
                    const PictureOptions& options = {}) {
  for (const Way& way : ways) {
    SCOPED_TRACE(name_of(way));
    expect_furnace(render(scene, way, options), way);
  }
}

class Geometry : public testing::TestWithParam<FurnaceScene> {};
TEST_P(Geometry, IsAsBrightByEveryWay) { expect_furnace(GetParam().scene, all_ways()); }

class View : public testing::TestWithParam<FurnaceScene> {};
TEST_P(View, IsAsBrightByEveryIntegrator) { expect_furnace(GetParam().scene, all_integrators()); }

std::string scene_name(const testing::TestParamInfo<FurnaceScene>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Broken, Geometry, testing::ValuesIn(broken_geometry()), scene_name);
INSTANTIATE_TEST_SUITE_P(Extreme, View, testing::ValuesIn(extreme_materials()), scene_name);
INSTANTIATE_TEST_SUITE_P(Misplaced, View, testing::ValuesIn(misplaced_cameras()), scene_name);

// Equal lamps in the same place: rays meet one of them, next-event estimation would find all. One is left.
TEST(Duplicates, LampsInOnePlaceCountOnce) { expect_furnace(duplicate_faces().scene, all_ways()); }

// ---------------------------------------------------------------------------------------------------------
// Large, small, and far from the origin: rounded to floats, the geometry is broken anew each time, and still
// nothing may be seen of it.

class Size : public testing::TestWithParam<float> {};
TEST_P(Size, DoesNotMatter) {
  expect_furnace(transformed(furnished_furnace(), GetParam()), all_ways());
  expect_furnace(transformed(triangle_soup(), GetParam()), all_integrators());
}
INSTANTIATE_TEST_SUITE_P(Stress, Size, testing::Values(1e-9f, 1e-6f, 1e-3f, 1e3f, 1e6f, 1e9f));

class Offset : public testing::TestWithParam<float> {};
TEST_P(Offset, DoesNotMatter) {
  const V3f offset = V3f(1.0f, -0.7f, 0.4f) * GetParam();
  expect_furnace(transformed(furnished_furnace(), 1.0f, offset), all_ways());
  expect_furnace(transformed(triangle_soup(), 1.0f, offset), all_integrators());
}
INSTANTIATE_TEST_SUITE_P(Stress, Offset, testing::Values(1e2f, 1e4f, 1e6f));

// ---------------------------------------------------------------------------------------------------------
// Depth: in a closed furnace of one albedo a, what has at most n edges is 1 - a^n of all.

TEST(Depth, IsAGeometricSeries) {
  for (const float albedo : {0.5f, 0.999f})
    for (const int depth : {1, 2, 3, 10, 100, 10000}) {
      SceneDescription scene = test::furnace_room(C3f(albedo), 1.0f);
      PictureOptions options;
      options.limits.max_depth = depth;
      options.samples = depth > 100 ? 8 : 16;
      options.width = options.height = 4;
      const double truth = -std::expm1(depth * std::log(static_cast<double>(albedo)));
      for (const IntegratorKind integrator :
           {IntegratorKind::path, IntegratorKind::unbiased, IntegratorKind::two_pass}) {
        const Picture picture = render(scene, {integrator}, options);
        ASSERT_EQ(fault_of(picture), "");
        const double bias = integrator == IntegratorKind::two_pass ? 0.03 * truth : 0.0;
        EXPECT_NEAR(picture.mean, truth, 4.4 * picture.error + bias + 1e-5)
            << albedo << " " << depth << " " << name_of({integrator});
        EXPECT_LT(picture.cpu_seconds, 10.0 * patience);
      }
    }
}

// A closed room that absorbs nothing has no balance: what is asked for does not exist. It ends all the same,
// with finite pixels, and the radiosity pass says what it did.
TEST(Albedo, OneInAClosedRoomEnds) {
  SceneDescription scene = test::unit_room(C3f(1.0f), C3f(1.0f), C3f(1.0f));
  PictureOptions options;
  options.width = options.height = 4;
  options.samples = 4;
  for (const Way& way : all_ways()) {
    SCOPED_TRACE(name_of(way));
    const Picture picture = render(scene, way, options);
    EXPECT_EQ(fault_of(picture), "");
    EXPECT_LT(picture.cpu_seconds, 10.0 * patience);
    if (way.integrator == IntegratorKind::radiosity) {
      ASSERT_FALSE(picture.notes.empty());
      EXPECT_NE(picture.notes[0].find("clamped"), std::string::npos) << picture.notes[0];
    }
  }
}

TEST(Dark, NothingIsSeenWithoutLight) {
  SceneDescription dark = furnished_furnace();
  dark.environment = Environment();
  for (Shape& shape : dark.shapes) shape.radiance = {C3f(0.0f), C3f(0.0f)};
  for (const SceneDescription& scene : {dark, SceneDescription{}})
    for (const Way& way : all_ways()) {
      const Picture picture = render(scene, way);
      EXPECT_EQ(fault_of(picture), "");
      EXPECT_EQ(picture.brightest, 0.0) << name_of(way);
    }
}

// One pixel, and a ribbon of 320 thousand.
TEST(PictureSize, FromOnePixelToARibbon) {
  for (const auto& [width, height] : {std::pair{1, 1}, {20000, 16}, {16, 20000}}) {
    PictureOptions options;
    options.width = width;
    options.height = height;
    options.samples = width * height == 1 ? 256 : 1;
    for (const IntegratorKind integrator : {IntegratorKind::path, IntegratorKind::two_pass}) {
      if (integrator == IntegratorKind::two_pass && height > width) continue;
      const Picture picture = render(furnished_furnace(), {integrator}, options);
      ASSERT_EQ(fault_of(picture), "");
      // A single sample a pixel tells nothing of its error, but there are many pixels.
      EXPECT_NEAR(picture.mean, 1.0, width * height == 1 ? 4.4 * picture.error + 0.03 : 0.03);
    }
  }
}

}  // namespace
}  // namespace twopass::stress
