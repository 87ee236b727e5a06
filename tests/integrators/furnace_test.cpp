// The constant-radiance furnace: if every surface emits (1 - albedo) L0, the radiance is L0 everywhere, in
// every direction, for every integrator. Leaks, double counting, wrong weights and wrong sides all show.
#include <gtest/gtest.h>

#include "integrators/make_integrator.h"
#include "radiosity/solution.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

struct FurnaceCase {
  std::string name;
  IntegratorKind kind;
  C3f reflectance;
  bool with_mirror, with_glass;
};

void PrintTo(const FurnaceCase& c, std::ostream* out) { *out << c.name; }

SceneDescription furnace(const FurnaceCase& c) {
  SceneDescription scene = test::furnace_room(c.reflectance, 2.0f);
  if (c.with_mirror)
    test::add_box(scene, "mirror", V3f(0.1f, 0.5f, 0.1f), V3f(0.3f, 0.7f, 0.5f),
                  one_sided("mirror", Conductor{}));
  if (c.with_glass) {
    test::add_diffuse(scene, "glass", Sphere{V3f(0.7f, 0.5f, 0.3f), 0.2f, false}, C3f(0.0f));
    scene.materials.back() = interface_material("glass", Dielectric{});
  }
  return scene;
}

class FurnaceTest : public testing::TestWithParam<FurnaceCase> {};

TEST_P(FurnaceTest, RadianceIsTheSameEverywhere) {
  const Scene scene(furnace(GetParam()));
  RadiosityOptions options;
  options.max_elements = 1500;
  options.relative_error = 1e-5;
  std::optional<Solution> solution;
  if (reads_solution(GetParam().kind)) solution.emplace(solve_radiosity(scene, options));
  const auto integrator = make_integrator(GetParam().kind, scene, {solution ? &*solution : nullptr}, {});
  // Both hemispheres from two places.
  for (const V3f& origin : {V3f(0.5f, 0.3f, 0.5f), V3f(0.9f, 0.9f, 0.9f)})
    for (const V3f& axis : {V3f(0, 0.6f, -0.8f), V3f(0, -0.6f, 0.8f)}) {
      const test::Estimate e = test::mean_radiance(*integrator, origin, axis, 0.0f, 30000, 5);
      // Level 1e-5 a mean; the solution's own noise and error bound are far below the 0.5 % allowed for them.
      const double allowance = solution ? 0.01 : 1e-5;
      EXPECT_NEAR(e.mean(), 2.0, 4.4 * e.standard_error() + allowance);
      EXPECT_LT(e.standard_error(), 0.02);
    }
}

INSTANTIATE_TEST_SUITE_P(
    Integrators, FurnaceTest,
    testing::Values(
        FurnaceCase{"path_grey", IntegratorKind::path, C3f(0.5f), false, false},
        FurnaceCase{"path_bright_mirror_glass", IntegratorKind::path, C3f(0.9f, 0.5f, 0.1f), true, true},
        FurnaceCase{"twopass_grey", IntegratorKind::two_pass, C3f(0.5f), false, false},
        FurnaceCase{"twopass_colour", IntegratorKind::two_pass, C3f(0.9f, 0.5f, 0.1f), false, false},
        FurnaceCase{"twopass_mirror", IntegratorKind::two_pass, C3f(0.6f), true, false},
        FurnaceCase{"twopass_mirror_glass", IntegratorKind::two_pass, C3f(0.9f, 0.5f, 0.1f), true, true},
        FurnaceCase{"radiosity_grey", IntegratorKind::radiosity, C3f(0.5f), false, false},
        FurnaceCase{"radiosity_mirror_glass", IntegratorKind::radiosity, C3f(0.5f), true, true}),
    [](const testing::TestParamInfo<FurnaceCase>& model) { return model.param.name; });

}  // namespace
}  // namespace twopass
