// Light from punctual lights, once by two passes and once by the path tracer.
#include <gtest/gtest.h>

#include "integrators/make_integrator.h"
#include "radiosity/solution.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

// A room without its ceiling, seen from above.
SceneDescription open_room(const PunctualLight& light) {
  SceneDescription scene = test::unit_room(C3f(0.7f), C3f(0.0f), C3f(0.7f));
  scene.shapes.erase(scene.shapes.begin() + 1);
  test::add_box(scene, "box", V3f(0.15f), V3f(0.4f), one_sided("box", Diffuse{C3f(0.7f)}));
  scene.punctual_lights.push_back(light);
  return scene;
}

SpotLight spot() {
  const M44d down(1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0.6, 0.6, 0.9, 1);
  return {light_frame(down), C3f(1.0f), 0.5f, 0.4f, {}};
}

class PunctualFamiliesTest : public testing::TestWithParam<PunctualLight> {};

TEST_P(PunctualFamiliesTest, TwoPassAgreesWithPath) {
  const Scene scene(open_room(GetParam()));
  RadiosityOptions options;
  options.max_elements = 3000;
  options.rays_per_element = 256;
  options.relative_error = 1e-3;
  const Solution solution = solve_radiosity(scene, options);
  const auto two_pass = make_integrator(IntegratorKind::two_pass, scene, {&solution}, {});
  const auto path = make_integrator(IntegratorKind::path, scene, {}, {});
  // At a wall in the shade, where much of the light is indirect.
  const V3f eye(0.7f, 0.5f, 0.95f), axis(0.3f, -0.5f, -0.6f);
  const test::Estimate ours = test::mean_radiance(*two_pass, eye, axis, 0.6f, 60000, 1);
  const test::Estimate truth = test::mean_radiance(*path, eye, axis, 0.6f, 60000, 2);
  ASSERT_GT(truth.mean(), 0.0);
  // Level 1e-5; 1 % for the elements.
  EXPECT_NEAR(ours.mean(), truth.mean(),
              4.4 * std::hypot(ours.standard_error(), truth.standard_error()) + 0.01 * truth.mean());
}

INSTANTIATE_TEST_SUITE_P(Lights, PunctualFamiliesTest,
                         testing::Values(PunctualLight(PointLight{V3f(0.5f, 0.6f, 0.8f), C3f(1.0f)}),
                                         PunctualLight(spot()),
                                         PunctualLight(DirectionalLight{V3f(-2, 1, -2) / 3.0f, C3f(1.0f)})),
                         [](const testing::TestParamInfo<PunctualLight>& model) {
                           return std::string(kind_name(model.param));
                         });

}  // namespace
}  // namespace twopass
