// The partition of light paths (integrators/two_pass.h): each family is carried exactly once. Every scene here
// lets through one family of paths beside emission, so a family that is dropped or counted twice is off by a
// factor.
#include <gtest/gtest.h>

#include "integrators/make_integrator.h"
#include "radiosity/caustic_map.h"
#include "radiosity/solution.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

const Material mirror = one_sided("mirror", Conductor{});
const Material wall = one_sided("wall", Diffuse{C3f(0.5f)});
const Material black = one_sided("black", Diffuse{C3f(0.0f)});

struct Case {
  std::string name;
  SceneDescription scene;
  V3f origin, axis;  // the camera
  float cos_half_angle;
};

Shape& add(SceneDescription& scene, const std::string& name, const Mesh& mesh, const Material& material) {
  Shape& shape = test::add_diffuse(scene, name, mesh, C3f(0.0f));
  scene.materials.back() = material;
  return shape;
}

// A floor (z = 0, facing up) and a lamp above it, facing down; the camera looks at the floor from below the
// lamp.
SceneDescription floor_and_lamp(const Material& floor) {
  SceneDescription scene;
  add(scene, "floor", test::quad(V3f(-1, -1, 0), V3f(2, 0, 0), V3f(0, 2, 0)), floor);
  add(scene, "lamp", test::quad(V3f(-0.5f, -0.5f, 2), V3f(0, 1, 0), V3f(1, 0, 0)), black).radiance[front] =
      C3f(5.0f);
  return scene;
}

// The lamp shines up only, onto a ceiling of the given material; the floor sees it there alone.
SceneDescription lamp_shines_up(const Material& ceiling) {
  SceneDescription scene;
  add(scene, "floor", test::quad(V3f(-1, -1, 0), V3f(2, 0, 0), V3f(0, 2, 0)), wall);
  add(scene, "ceiling", test::quad(V3f(-1, -1, 2), V3f(0, 2, 0), V3f(2, 0, 0)), ceiling);
  add(scene, "lamp", test::quad(V3f(-0.3f, -0.3f, 1), V3f(0.6f, 0, 0), V3f(0, 0.6f, 0)), black)
      .radiance[front] = C3f(5.0f);
  return scene;
}

// Two patches of floor with a screen between them; the lamp shines down onto the left one. Only by way of the
// mirror above does light reach the right one.
SceneDescription by_way_of_a_mirror() {
  SceneDescription scene;
  add(scene, "left", test::quad(V3f(-1, -0.5f, 0), V3f(0.8f, 0, 0), V3f(0, 1, 0)), wall);
  add(scene, "right", test::quad(V3f(0.2f, -0.5f, 0), V3f(0.8f, 0, 0), V3f(0, 1, 0)), wall);
  add(scene, "screen", test::quad(V3f(0, -3, 0), V3f(0, 6, 0), V3f(0, 0, 0.9f)), black);
  add(scene, "lamp", test::quad(V3f(-0.7f, -0.1f, 0.3f), V3f(0, 0.2f, 0), V3f(0.2f, 0, 0)), black)
      .radiance[front] = C3f(50.0f);
  add(scene, "mirror", test::quad(V3f(-2, -2, 2), V3f(0, 4, 0), V3f(4, 0, 0)), mirror);
  return scene;
}

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::vector<Case> cases() {
  std::vector<Case> all;
  const V3f down(0, 0, -1), eye(0.2f, 0.1f, 1.0f);
  all.push_back({"Le", floor_and_lamp(black), eye, V3f(0, 0, 1), 0.8f});
  SceneDescription seen_in_mirror = floor_and_lamp(mirror);
  all.push_back({"LeS", seen_in_mirror, eye, down, 0.8f});
  all.push_back({"LD", floor_and_lamp(wall), eye, down, 0.8f});
  all.push_back({"LSD", lamp_shines_up(mirror), V3f(0.9f, 0.9f, 0.5f), V3f(-0.5f, -0.5f, -0.5f), 0.9f});
  all.push_back({"LDD", lamp_shines_up(wall), V3f(0.9f, 0.9f, 0.5f), V3f(-0.5f, -0.5f, -0.5f), 0.9f});
  all.push_back({"LDSD", by_way_of_a_mirror(), V3f(0.6f, 0, 0.8f), V3f(0, 0, -1), 0.95f});
  // The lamp behind glass: caustics at x and at the elements, L S S D (D).
  SceneDescription behind_glass = lamp_shines_up(wall);
  test::add_diffuse(behind_glass, "glass", Sphere{V3f(0, 0, 1.5f), 0.2f, false}, C3f(0.0f));
  behind_glass.materials.back() = interface_material("glass", Dielectric{});
  all.push_back({"LSSDD", behind_glass, V3f(0.9f, 0.9f, 0.5f), V3f(-0.5f, -0.5f, -0.5f), 0.9f});
  SceneDescription room = test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.5f));
  all.push_back({"LDDD", room, V3f(0.5f), V3f(0, 0, -1), 0.5f});
  return all;
}

class FamiliesTest : public testing::TestWithParam<Case> {};

TEST_P(FamiliesTest, TwoPassCarriesTheFamilyOnce) {
  const Case& c = GetParam();
  const Scene scene(c.scene);
  RadiosityOptions options;
  options.max_elements = 4000;
  options.rays_per_element = 512;
  options.relative_error = 1e-3;
  const Solution solution = solve_radiosity(scene, options);
  const auto two_pass = make_integrator(IntegratorKind::two_pass, scene, {&solution}, {});
  const auto path = make_integrator(IntegratorKind::path, scene, {}, {});
  const test::Estimate ours = test::mean_radiance(*two_pass, c.origin, c.axis, c.cos_half_angle, 100000, 1);
  const test::Estimate truth = test::mean_radiance(*path, c.origin, c.axis, c.cos_half_angle, 200000, 2);
  ASSERT_GT(truth.mean(), 0.0) << "the family must be there at all";
  EXPECT_LT(truth.standard_error() / truth.mean(), 0.03);
  // A family lost or doubled is 100 % off; elements and their rays may be off by 1 %. Level 1e-5.
  EXPECT_NEAR(ours.mean(), truth.mean(),
              4.4 * std::hypot(ours.standard_error(), truth.standard_error()) + 0.01 * truth.mean());
  // The same with caustics from a map.
  const CausticMap caustics(scene, CausticParticles(scene));
  if (caustics.empty()) return;
  const auto with_map =
      make_integrator(IntegratorKind::two_pass, scene, {.solution = &solution, .caustics = &caustics}, {});
  const test::Estimate mapped = test::mean_radiance(*with_map, c.origin, c.axis, c.cos_half_angle, 100000, 1);
  EXPECT_NEAR(mapped.mean(), truth.mean(),
              4.4 * std::hypot(mapped.standard_error(), truth.standard_error()) + 0.015 * truth.mean());
}

INSTANTIATE_TEST_SUITE_P(Families, FamiliesTest, testing::ValuesIn(cases()),
                         [](const testing::TestParamInfo<Case>& model) { return model.param.name; });

// Length by length: with at most n edges both must agree, too, for every n.
TEST(Families, EveryLengthOfPathIsCarriedOnce) {
  const Scene scene(test::unit_room(C3f(0.6f), C3f(1.0f), C3f(0.6f)));
  for (int depth = 1; depth <= 6; ++depth) {
    RadiosityOptions options;
    options.max_elements = 3000;
    options.relative_error = 1e-4;
    options.max_reflections = std::max(0, depth - edges_to_solution(IntegratorKind::two_pass));
    const PathLimits limits{depth, 5, false};
    const Solution solution = solve_radiosity(scene, options);
    const auto two_pass =
        make_integrator(IntegratorKind::two_pass, scene, {depth >= 3 ? &solution : nullptr}, limits);
    const auto path = make_integrator(IntegratorKind::path, scene, {}, limits);
    const test::Estimate ours = test::mean_radiance(*two_pass, V3f(0.5f), V3f(0, 0.5f, -1), 0.0f, 60000, 1);
    const test::Estimate truth = test::mean_radiance(*path, V3f(0.5f), V3f(0, 0.5f, -1), 0.0f, 120000, 2);
    EXPECT_NEAR(ours.mean(), truth.mean(),
                4.4 * std::hypot(ours.standard_error(), truth.standard_error()) + 0.003 * truth.mean())
        << "depth " << depth;
  }
}

}  // namespace
}  // namespace twopass
