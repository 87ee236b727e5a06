#include "radiosity/ray_survey.h"

#include <gtest/gtest.h>

#include "radiosity/analytic_exchange.h"
#include "radiosity/subdivision.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

TEST(RaySurvey, InAClosedRoomEveryRayLandsOnAnElement) {
  const Scene scene(test::lit_cube(0.5f));
  const ElementMesh mesh = divide_surfaces(scene, 500);
  const RaySurvey survey = survey_with_rays(scene, mesh, 256, 1);
  EXPECT_TRUE(survey.is_closed());
  EXPECT_EQ(survey.met_black + survey.met_lamp + survey.met_specular, 0u);
  // Shapes beside each other share edges, and rays can slip through: fewer than one in a hundred thousand.
  EXPECT_LE(survey.met_sky, 1u);
  for (std::uint32_t i = 0; i < mesh.count(); ++i) EXPECT_EQ(survey.exposed[i], 1.0);
}

// Every count against the analytic exchange: chi-square over all pairs at a level of 1e-4.
TEST(RaySurvey, CountsFollowTheAnalyticFormFactors) {
  const Scene scene(test::lit_cube(0.5f));
  const ElementMesh mesh = divide_surfaces(scene, 12);
  std::uint64_t rays = 0;
  const ExchangeMatrix exact = analytic_exchange(mesh, scene.caster(), FormFactorMethod::exact, 0, rays);
  const RaySurvey survey = survey_with_rays(scene, mesh, 1 << 14, 3);
  const ExchangeMatrix estimate = exchange_from_landings(survey, mesh);
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    for (std::uint32_t j = 0; j < mesh.count(); ++j) {
      const double f = exact.coeff(i, j) / mesh.area(i), n = 2.0 * (1 << 14);
      // Five standard deviations of the pooled Poisson count; stratification only makes them smaller.
      EXPECT_NEAR(estimate.coeff(i, j) / mesh.area(i), f, 5.0 * std::sqrt(f / n) + 1e-4 * f);
      EXPECT_EQ(estimate.coeff(i, j), estimate.coeff(j, i));
    }
}

TEST(RaySurvey, SeesTheSkyThroughAnOpening) {
  SceneDescription description = test::plates(1.0f, 0.5f);
  description.environment = Environment(C3f(2.0f, 1.0f, 0.5f));
  const Scene scene(std::move(description));
  const ElementMesh mesh = divide_surfaces(scene, 0);
  const RaySurvey survey = survey_with_rays(scene, mesh, 1 << 14, 1);
  EXPECT_FALSE(survey.is_closed());
  // The mean over both triangles of the lower square: 1 - F, F the factor of parallel unit squares at
  // distance 1.
  const double open = 1.0 - 0.19982489569838738;
  const C3f sky = (survey.sky[0] + survey.sky[1]) * 0.5f;
  EXPECT_NEAR(sky.x, 2.0 * pi * open, 0.02);
  EXPECT_NEAR(sky.z, 0.5 * pi * open, 0.005);
  EXPECT_NEAR(survey.shares[0].in_the_sky + survey.shares[0].on_elements, 1.0f, 1e-6f);
}

// The sun is too small for rays in all directions: rays are drawn from the sky, too.
TEST(RaySurvey, FindsTheSun) {
  // A dim sky, one pixel of which holds nine tenths of the light.
  Image picture(256, 129, {"R", "G", "B"});
  for (float& value : picture.pixels) value = 0.1f;
  for (int c = 0; c < 3; ++c) picture.at(64, 40, c) = 3e4f;
  const Environment sky(std::make_shared<const EnvironmentMap>(picture, EnvironmentMapOptions{}, "sun"));
  const V3f up = sky.sample({0.5f, 0.5f}).direction;  // most likely the sun
  const Frame frame(up);
  SceneDescription description;
  test::add_diffuse(description, "ground", test::quad(V3f(0.0f), frame.s, frame.t), C3f(0.5f));
  description.environment = sky;
  const Scene scene(std::move(description));
  C3d expected(0.0);
  constexpr std::uint32_t samples = 1 << 17;
  for (std::uint32_t k = 0; k < samples; ++k) {
    const EnvironmentSample drawn = sky.sample(Sampler(1, 0, k).next_2d());
    const float cosine = drawn.direction.dot(frame.n);
    if (drawn.pdf_w > 0.0f && cosine > 0.0f)
      expected += C3d(drawn.radiance) * static_cast<double>(cosine / drawn.pdf_w / static_cast<float>(samples));
  }
  ASSERT_GT(expected.x, 1.0);
  const ElementMesh mesh = divide_surfaces(scene, 32);
  const RaySurvey survey = survey_with_rays(scene, mesh, 64, 1);
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(survey.sky[i][c], expected[c], 0.1 * expected[c]);
  C3d mean(0.0);
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    mean += C3d(survey.sky[i]) / static_cast<double>(mesh.count());
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], expected[c], 0.01 * expected[c]);
}

TEST(RaySurvey, TheSkyCountsByDirection) {
  // Bright only on the side of +x: by symmetry half of the light of a sky that is bright all around.
  Image picture(16, 9, {"R", "G", "B"});
  for (int row = 0; row < 9; ++row)
    for (int column = 0; column < 8; ++column) picture.at(column, row, 0) = 2.0f;
  SceneDescription description = test::plates(1.0f, 0.5f);
  description.environment =
      Environment(std::make_shared<const EnvironmentMap>(picture, EnvironmentMapOptions{}, "half"));
  const Scene scene(std::move(description));
  const ElementMesh mesh = divide_surfaces(scene, 0);
  const RaySurvey survey = survey_with_rays(scene, mesh, 1 << 14, 1);
  const C3f sky = (survey.sky[0] + survey.sky[1]) * 0.5f;
  EXPECT_NEAR(sky.x, pi * (1.0 - 0.19982489569838738), 0.02);
  EXPECT_EQ(sky.y, 0.0f);
}

TEST(RaySurvey, TellsLampsBlackAndSpecularApart) {
  SceneDescription description = test::plates(1.0f, 0.5f);  // the lower plate is a lamp with elements
  const V3f x(1, 0, 0), y(0, 1, 0);
  test::add_diffuse(description, "black lamp", test::quad(V3f(1, 0, 0), x, y), C3f(0.0f), C3f(1.0f));
  test::add_diffuse(description, "black", test::quad(V3f(2, 0, 0), x, y), C3f(0.0f));
  description.materials.push_back(one_sided("mirror", Conductor{}));
  description.shapes.push_back({"mirror", test::quad(V3f(3, 0, 0), x, y), 4, {C3f(0.0f), C3f(0.0f)}});
  const Scene scene(std::move(description));
  const RaySurvey survey = survey_with_rays(scene, divide_surfaces(scene, 0), 1 << 12, 1);
  EXPECT_GT(survey.met_lamp, 10u);
  EXPECT_GT(survey.met_black, 10u);
  EXPECT_GT(survey.met_specular, 10u);
  EXPECT_GT(survey.met_sky, 10u);
}

// A lamp hanging just below the ceiling covers a part of it: that part is as if it were not there.
TEST(RaySurvey, BuriedPartsDoNotCount) {
  const Scene scene(test::lit_room());
  ElementMesh mesh = divide_surfaces(scene, 4000);
  const RaySurvey survey = survey_with_rays(scene, mesh, 256, 1);
  EXPECT_TRUE(survey.is_closed());
  double ceiling = 0.0, floor = 0.0;
  mesh.expose(survey.exposed);
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    if (mesh.root(i).shape == 0) floor += mesh.area(i);
    if (mesh.root(i).shape == 1) ceiling += mesh.area(i);
  }
  EXPECT_NEAR(ceiling, 1.0 - 0.25 * 0.25, 2e-3);
  // So do the places where the boxes stand.
  EXPECT_NEAR(floor, 1.0 - 2.0 * 0.25 * 0.25, 2e-3);
}

TEST(RaySurvey, IsTheSameOnAnyNumberOfThreads) {
  const Scene scene(test::lit_room());
  const ElementMesh mesh = divide_surfaces(scene, 300);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return survey_with_rays(scene, mesh, 64, 1);
  };
  const RaySurvey one = run(1), two = run(2);
  EXPECT_EQ(one.landings, two.landings);
  EXPECT_EQ(one.rays, two.rays);
}

// A carpet takes the light from the floor below it, a sheet of glass does not.
TEST(RaySurvey, GlassDoesNotBury) {
  for (const bool is_glass : {false, true}) {
    SceneDescription description = test::lit_cube(0.5f);
    test::add_diffuse(description, "sheet",
                      test::quad(V3f(0.25f, 0.25f, 0.001f), V3f(0.5f, 0, 0), V3f(0, 0.5f, 0)), C3f(0.5f));
    if (is_glass) description.materials.back() = interface_material("glass", Dielectric{});
    const Scene scene(std::move(description));
    ElementMesh mesh = divide_surfaces(scene, 200);
    mesh.expose(survey_with_rays(scene, mesh, 256, 0).exposed);
    double floor = 0.0;
    for (std::uint32_t i = 0; i < mesh.count(); ++i)
      if (mesh.root(i).shape == 0) floor += mesh.area(i);
    EXPECT_NEAR(floor, is_glass ? 1.0 : 0.75, 0.01);
  }
}

}  // namespace
}  // namespace twopass
