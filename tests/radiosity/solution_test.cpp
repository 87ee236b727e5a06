#include "radiosity/solution.h"

#include <gtest/gtest.h>

#include "render/core/error.h"
#include "render/core/parallel.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

RadiosityOptions options_for(FormFactorMethod method, std::size_t elements, double error = 1e-4) {
  RadiosityOptions options;
  options.form_factors = method;
  options.max_elements = elements;
  options.relative_error = error;
  options.hemicube_resolution = 16;
  return options;
}

constexpr FormFactorMethod methods[] = {FormFactorMethod::exact, FormFactorMethod::point,
                                        FormFactorMethod::hemicube, FormFactorMethod::rays};
constexpr Solver all_solvers[] = {Solver::lu, Solver::jacobi, Solver::gauss_seidel, Solver::progressive,
                                  Solver::cg};

void expect_sane(const Solution& solution) {
  for (const Irradiance& irradiance : solution.irradiances())
    for (int c = 0; c < 3; ++c) {
      EXPECT_TRUE(std::isfinite(irradiance.direct[c]) && std::isfinite(irradiance.indirect[c]));
      EXPECT_GE(irradiance.direct[c], 0.0f);
      EXPECT_GE(irradiance.indirect[c], 0.0f);
    }
}

bool equal(const Solution& a, const Solution& b) {
  for (std::size_t i = 0; i < a.irradiances().size(); ++i)
    if (a.irradiances()[i].direct != b.irradiances()[i].direct ||
        a.irradiances()[i].indirect != b.irradiances()[i].indirect)
      return false;
  return a.irradiances().size() == b.irradiances().size();
}

TEST(Solution, IsTheSameBitForBitOnAnyNumberOfThreads) {
  const Scene scene(test::lit_room());
  for (const FormFactorMethod method : methods) {
    const auto run = [&](int threads) {
      const ThreadLimit limit(threads);
      return solve_radiosity(scene, options_for(method, 300));
    };
    EXPECT_TRUE(equal(run(1), run(2)));
  }
}

TEST(Solution, OtherSeedsOtherNoise) {
  const Scene scene(test::lit_room());
  RadiosityOptions options = options_for(FormFactorMethod::rays, 300);
  const Solution first = solve_radiosity(scene, options);
  options.seed = 7;
  EXPECT_FALSE(equal(first, solve_radiosity(scene, options)));
}

TEST(Solution, AllSolversAgreeOnTheSameBalance) {
  const Scene scene(test::lit_room());
  std::vector<Solution> solution;
  RadiosityOptions options = options_for(FormFactorMethod::rays, 500, 1e-5);
  options.rays_per_element = 256;
  for (const Solver solver : all_solvers) {
    options.solver = solver;
    solution.push_back(solve_radiosity(scene, options));
    EXPECT_EQ(solution.back().stats().solver, name_of_value<Solver>(solver_names, solver));
    EXPECT_LE(solution.back().stats().error_bound, 1e-6);
  }
  options.solver = Solver::progressive;
  for (const bool overshoot : {false, true}) {
    options.overshoot = overshoot;
    solution.push_back(solve_radiosity(scene, options));
    EXPECT_LE(solution.back().stats().error_bound, 1e-6);
  }
  const std::size_t last = solution.size() - 1;
  EXPECT_LT(solution[last].stats().iterations, solution[last - 1].stats().iterations);
  for (std::size_t i = 0; i < solution[0].irradiances().size(); ++i)
    for (std::size_t other = 1; other <= last; ++other)
      EXPECT_NEAR(solution[other].irradiances()[i].indirect.x, solution[0].irradiances()[i].indirect.x,
                  2e-3 * solution[0].irradiances()[i].indirect.x);
}

TEST(Solution, KnowsEverySurfaceByItsSide) {
  const Scene scene(test::lit_room());
  const Solution solution = solve_radiosity(scene, options_for(FormFactorMethod::rays, 2000));
  const auto see = [&](const V3f& origin, const V3f& direction) {
    const Ray ray{origin, direction};
    return scene.surface_point(ray, scene.caster().intersect(ray));
  };
  const SurfacePoint floor = see(V3f(0.4f, 0.4f, 0.5f), V3f(0, 0, -1));
  EXPECT_GT(solution.irradiance(floor).direct.x, 0.2f);
  EXPECT_GT(solution.irradiance(floor).indirect.x, 0.1f);
  EXPECT_NEAR(solution.smooth_irradiance(floor).total().x / solution.irradiance(floor).total().x, 1.0f, 0.3f);
  const SurfacePoint from_below = see(V3f(0.4f, 0.4f, -0.5f), V3f(0, 0, 1));
  EXPECT_EQ(from_below.side, back);
  EXPECT_EQ(solution.irradiance(from_below).total(), C3f(0.0f));
  EXPECT_EQ(solution.smooth_irradiance(from_below).total(), C3f(0.0f));
}

TEST(Solution, DarkEmptyAndDegenerateScenesAreNoTrouble) {
  EXPECT_EQ(solve_radiosity(Scene(SceneDescription{})).stats().elements, 0u);
  SceneDescription dark = test::lit_cube(0.5f);
  dark.shapes[1].radiance[front] = C3f(0.0f);
  const Solution night = solve_radiosity(Scene(dark));
  EXPECT_FALSE(night.stats().notes.empty());

  SceneDescription lone;
  test::add_diffuse(lone, "tile", test::quad(V3f(0.0f), V3f(1, 0, 0), V3f(0, 1, 0)), C3f(0.5f), C3f(1.0f));
  Mesh flat;
  flat.positions = {V3f(0.0f), V3f(1.0f), V3f(2.0f)};
  flat.triangles = {{0, 1, 2}};
  test::add_diffuse(lone, "flat", flat, C3f(0.5f), C3f(1.0f));
  for (const FormFactorMethod method : methods)
    for (const Solver solver : all_solvers) {
      RadiosityOptions options = options_for(method, 50);
      options.solver = solver;
      const Scene scene(lone);
      const Solution solution = solve_radiosity(scene, options);
      expect_sane(solution);
      EXPECT_EQ(solution.irradiances()[0].total(), C3f(0.0f));
    }
}

TEST(Solution, ReflectancesOfOneAreClampedAndSaidSo) {
  SceneDescription description = test::lit_cube(1.0f);
  description.shapes[0].material = 1;
  description.materials[1] = one_sided("half", Diffuse{C3f(0.5f)});
  const Scene scene(std::move(description));
  const Solution solution = solve_radiosity(scene, options_for(FormFactorMethod::rays, 100, 0.1));
  expect_sane(solution);
  EXPECT_EQ(solution.stats().notes.size(), 1u);
  EXPECT_LE(solution.stats().error_bound, 0.1);
}

TEST(Solution, RefusesTooManyElementsForItsMethods) {
  const Scene scene(test::lit_cube(0.5f));
  EXPECT_THROW(solve_radiosity(scene, options_for(FormFactorMethod::exact, 20000)), Error);
  RadiosityOptions options = options_for(FormFactorMethod::rays, 20000);
  options.solver = Solver::lu;
  EXPECT_THROW(solve_radiosity(scene, options), Error);
  options.max_elements = 0;
  EXPECT_LE(solve_radiosity(scene, options).stats().elements, 3000u);
}

TEST(Solution, OnlyShootingOvershoots) {
  const Scene scene(test::lit_cube(0.5f));
  RadiosityOptions options = options_for(FormFactorMethod::rays, 100);
  options.overshoot = true;
  EXPECT_THROW(solve_radiosity(scene, options), Error);
  options.solver = Solver::progressive;
  EXPECT_LE(solve_radiosity(scene, options).stats().error_bound, 1e-5);
}

TEST(Solution, StatsTellWhatWasDone) {
  const Scene scene(test::lit_room());
  const RadiosityStats stats =
      solve_radiosity(scene, options_for(FormFactorMethod::automatic, 500, 0.01)).stats();
  EXPECT_EQ(stats.form_factors, "rays");
  EXPECT_EQ(stats.solver, "cg");
  EXPECT_TRUE(stats.closed);
  EXPECT_GT(stats.links, 1000u);
  EXPECT_GT(stats.rays, 100000u);
  EXPECT_GT(stats.iterations, 2u);
  EXPECT_LE(stats.error_bound, 0.001);
  EXPECT_LE(stats.residual, stats.error_bound);
  EXPECT_GT(stats.memory_bytes, stats.links * 8);
}

}  // namespace
}  // namespace twopass
