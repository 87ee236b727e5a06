// Scenes that break radiosity programs, through every method and every solver.
#include <gtest/gtest.h>

#include "radiosity/solution.h"
#include "render/core/error.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

struct Way {
  FormFactorMethod method;
  Solver solver;
};

// Every method with the default solver, and every solver with the default method.
std::vector<Way> all_ways() {
  std::vector<Way> ways;
  for (const auto& [name, method] : form_factor_method_names) ways.push_back({method, Solver::automatic});
  for (const auto& [name, solver] : solver_names)
    if (solver != Solver::automatic) ways.push_back({FormFactorMethod::automatic, solver});
  return ways;
}

class Stress : public testing::TestWithParam<Way> {
 protected:
  [[nodiscard]] static RadiosityOptions options() {
    RadiosityOptions options;
    options.form_factors = GetParam().method;
    options.solver = GetParam().solver;
    options.max_elements = 200;
    options.rays_per_element = 256;
    options.hemicube_resolution = 16;
    options.relative_error = 0.02;
    return options;
  }
  [[nodiscard]] static Solution solve(SceneDescription description) {
    scene_ = std::make_unique<Scene>(std::move(description));
    Solution solution = solve_radiosity(*scene_, options());
    for (const Irradiance& irradiance : solution.irradiances())
      for (int c = 0; c < 3; ++c) {
        EXPECT_TRUE(std::isfinite(irradiance.direct[c]) && std::isfinite(irradiance.indirect[c]));
        EXPECT_GE(irradiance.direct[c], 0.0f);
        EXPECT_GE(irradiance.indirect[c], 0.0f);
      }
    EXPECT_TRUE(std::isfinite(solution.stats().error_bound) && std::isfinite(solution.stats().residual));
    return solution;
  }
  // Reflected power, W, first channel.
  [[nodiscard]] static double reflected_power(const Solution& solution) {
    double sum = 0.0;
    for (std::uint32_t i = 0; i < solution.mesh().count(); ++i)
      sum += solution.mesh().area(i) *
             static_cast<double>(solution.mesh().reflectance(i).x * solution.irradiances()[i].total().x);
    return sum;
  }

 private:
  static inline std::unique_ptr<Scene> scene_;  // a solution refers to its scene
};

SceneDescription scaled(SceneDescription scene, float factor, const V3f& offset = V3f(0.0f)) {
  for (Shape& shape : scene.shapes)
    for (V3f& p : std::get<Mesh>(shape.geometry).positions) p = p * factor + offset;
  return scene;
}

TEST_P(Stress, AlbedoNearOneConservesEnergy) {
  // Exact for any geometry and mesh: Sum A B = Sum A E / (1 - rho), E the emission, B with it.
  constexpr double rho = 0.999;
  const Solution solution = solve(test::lit_cube(static_cast<float>(rho)));
  EXPECT_NEAR(reflected_power(solution) / (rho / (1.0 - rho)), 1.0, 0.03);
}

TEST_P(Stress, ScaleDoesNotMatter) {
  const double unit = reflected_power(solve(test::lit_room()));
  for (const float factor : {1e-6f, 1e-3f, 1e3f, 1e6f})
    EXPECT_NEAR(reflected_power(solve(scaled(test::lit_room(), factor))) / (unit * factor * factor), 1.0, 0.02)
        << factor;
}

TEST_P(Stress, NeitherDoesThePlace) {
  const double unit = reflected_power(solve(test::lit_room()));
  // A thousand room sizes away, floats still tell a thousandth of the lamp's height above the ceiling apart.
  EXPECT_NEAR(reflected_power(solve(scaled(test::lit_room(), 1.0f, V3f(1000.0f, -1000.0f, 500.0f)))) / unit,
              1.0, GetParam().method == FormFactorMethod::hemicube ? 0.05 : 0.03);
}

TEST_P(Stress, SliversDoNotHurt) {
  SceneDescription scene = test::lit_room();
  Mesh slivers;
  for (int k = 0; k < 10; ++k) {
    const float y = 0.05f + 0.09f * static_cast<float>(k);
    slivers.positions.insert(slivers.positions.end(),
                             {V3f(0.05f, y, 0.2f), V3f(0.95f, y, 0.2f), V3f(0.95f, y + 1e-6f, 0.2f)});
    const auto i = static_cast<std::uint32_t>(3 * k);
    slivers.triangles.emplace_back(i, i + 1, i + 2);
  }
  test::add_diffuse(scene, "slivers", slivers, C3f(0.7f));
  const double without = reflected_power(solve(test::lit_room()));
  // One point stands for a whole sliver in these methods.
  const bool by_points =
      GetParam().method == FormFactorMethod::point || GetParam().method == FormFactorMethod::hemicube;
  const double tolerance = by_points ? 0.06 : 0.03;
  EXPECT_NEAR(reflected_power(solve(std::move(scene))) / without, 1.0, tolerance);
}

TEST_P(Stress, DuplicateAndReversedFaces) {
  SceneDescription scene = test::lit_room();
  const std::vector<Shape> once = scene.shapes;
  for (const Shape& shape : once) {
    if (shape.name == "lamp") continue;
    scene.shapes.push_back(shape);
    Shape reversed = shape;
    for (V3u& t : std::get<Mesh>(reversed.geometry).triangles) std::swap(t.y, t.z);
    scene.shapes.push_back(reversed);
  }
  // Which of two equal faces a ray meets is up to the ray caster: nothing is promised but a sane answer.
  const Solution solution = solve(std::move(scene));
  const double without = reflected_power(solve(test::lit_room()));
  EXPECT_LT(reflected_power(solution), 2.5 * without);
}

TEST_P(Stress, TrianglesWithoutArea) {
  SceneDescription scene = test::lit_room();
  Mesh none;
  none.positions = {V3f(0.5f), V3f(0.5f), V3f(0.5f), V3f(0.25f), V3f(0.75f)};
  none.triangles = {{0, 1, 2}, {0, 0, 1}, {3, 0, 4}};
  test::add_diffuse(scene, "none", none, C3f(0.7f));
  test::add_diffuse(scene, "dark lamp", none, C3f(0.7f), C3f(1.0f));
  const double without = reflected_power(solve(test::lit_room()));
  EXPECT_NEAR(reflected_power(solve(std::move(scene))) / without, 1.0, 0.03);
}

TEST_P(Stress, OpenScenes) {
  // One element each, exact linear algebra: B1 = 1.010083152275 with emission, B2 = .100919880275.
  const Solution solution = solve(test::plates(1.0f, 0.5f));
  EXPECT_NEAR(reflected_power(solution), 0.0102 + 0.1009, 0.004);
}

TEST_P(Stress, NoLightAndOnlyLight) {
  EXPECT_EQ(reflected_power(solve(test::lit_cube(0.5f))) > 0.0, true);
  SceneDescription dark = test::lit_room();
  for (Shape& shape : dark.shapes) shape.radiance = {C3f(0.0f), C3f(0.0f)};
  EXPECT_EQ(reflected_power(solve(std::move(dark))), 0.0);
  SceneDescription only;
  test::add_diffuse(only, "lamp", test::quad(V3f(0.0f), V3f(1, 0, 0), V3f(0, 1, 0)), C3f(0.0f), C3f(1.0f));
  EXPECT_EQ(solve(std::move(only)).mesh().count(), 0u);
  SceneDescription lone;
  test::add_diffuse(lone, "bright lamp", test::quad(V3f(0.0f), V3f(1, 0, 0), V3f(0, 1, 0)), C3f(0.5f),
                    C3f(1.0f));
  EXPECT_EQ(reflected_power(solve(std::move(lone))), 0.0);
  EXPECT_EQ(solve(SceneDescription{}).mesh().count(), 0u);
}

std::string way_name(const testing::TestParamInfo<Way>& info) {
  std::string name(name_of_value<FormFactorMethod>(form_factor_method_names, info.param.method));
  name += "_";
  name += name_of_value<Solver>(solver_names, info.param.solver);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(EveryWay, Stress, testing::ValuesIn(all_ways()), way_name);

}  // namespace
}  // namespace twopass
