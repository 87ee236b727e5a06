#include "radiosity/stochastic.h"

#include <deque>

#include <gtest/gtest.h>

#include "radiosity/analytic_exchange.h"
#include "radiosity/form_factor_pair.h"
#include "radiosity/ray_survey.h"
#include "radiosity/solution.h"
#include "radiosity/solvers.h"
#include "radiosity/subdivision.h"
#include "render/core/error.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "tests/radiosity/polygon_samples.h"
#include "tests/radiosity/test_scenes.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

// A scene, its elements and some direct irradiance. What lights it does not matter to the solver.
struct Problem {
  explicit Problem(SceneDescription description, std::size_t elements)
      : scene(std::move(description)), mesh(divide_surfaces(scene, elements)) {
    direct.assign(mesh.count(), C3f(1.0f));
  }

  // Different on each element and in each channel; nothing on some.
  Problem& light_unevenly() {
    for (std::uint32_t i = 0; i < direct.size(); ++i)
      direct[i] = i % 3 == 0 ? C3f(0.0f) : C3f(float(i % 5), 0.5f, 1e-4f * float(i % 7));
    return *this;
  }

  [[nodiscard]] StochasticResult solve(const StochasticOptions& options) const {
    return solve_stochastic(scene, mesh, direct, options);
  }

  [[nodiscard]] C3d reflectance(std::uint32_t i) const {
    C3d rho;
    for (int c = 0; c < 3; ++c)
      rho[c] = static_cast<double>(std::min(mesh.reflectance(i)[c], largest_reflectance));
    return rho;
  }

  // The same equations with exact form factors.
  [[nodiscard]] Balance exact_balance() const {
    Balance balance;
    std::uint64_t rays = 0;
    balance.exchange = analytic_exchange(mesh, scene.caster(), FormFactorMethod::exact, 0, rays);
    for (std::uint32_t i = 0; i < mesh.count(); ++i) {
      balance.area.push_back(mesh.area(i));
      balance.reflectance.push_back(C3f(reflectance(i)));
      balance.direct.emplace_back(direct[i]);
    }
    return balance;
  }

  Scene scene;
  ElementMesh mesh;
  std::vector<C3f> direct;
};

SceneDescription coloured_cube() {
  SceneDescription scene = test::lit_cube(0.5f);
  const C3f colours[] = {C3f(0.8f, 0.7f, 0.6f), C3f(0.9f, 0.9f, 0.9f), C3f(0.7f, 0.1f, 0.05f),
                         C3f(0.1f, 0.6f, 0.1f), C3f(0.5f, 0.5f, 0.5f), C3f(0.0f, 0.3f, 0.99f)};
  for (std::size_t k = 0; k < 6; ++k)
    scene.materials[k] = one_sided("wall " + std::to_string(k), Diffuse{colours[k]});
  return scene;
}

// A cube with a mirror for its left wall and a glass ball in it.
SceneDescription mirror_room() {
  SceneDescription scene = coloured_cube();
  scene.materials[2] = one_sided("mirror", Conductor{});
  scene.materials.push_back(interface_material("glass", Dielectric{}));
  const auto glass = static_cast<std::uint32_t>(scene.materials.size() - 1);
  scene.shapes.push_back({"ball", Sphere{V3f(0.5f, 0.5f, 0.4f), 0.3f, false}, glass, {C3f(0.0f), C3f(0.0f)}});
  return scene;
}

StochasticOptions options_for(double rays, std::uint32_t seed = 0, double error = 1e-3) {
  StochasticOptions options;
  options.rays_per_element = rays;
  options.relative_error = error;
  options.seed = seed;
  return options;
}

// What many seeds say of each element's irradiance.
std::vector<std::array<test::Estimate, 3>> replicate(const Problem& problem, StochasticOptions options,
                                                     std::uint32_t seeds) {
  std::vector<std::array<test::Estimate, 3>> estimate(problem.mesh.count());
  for (options.seed = 1; options.seed <= seeds; ++options.seed) {
    const StochasticResult result = problem.solve(options);
    for (std::size_t i = 0; i < estimate.size(); ++i)
      for (int c = 0; c < 3; ++c) estimate[i][size_t(c)].add(static_cast<double>(result.irradiance[i][c]));
  }
  return estimate;
}

// Every element and channel against the truth: z-tests of which all together err with probability `level`.
// Student's t of n - 1 degrees has a variance (n - 1)/(n - 3) times a normal one's and longer tails, which is
// allowed for by a factor. `bias`: the part of the truth that stopping early may lose.
void expect_mean(const std::vector<std::array<test::Estimate, 3>>& estimate, const std::vector<C3d>& truth,
                 double bias, double level = 1e-4) {
  const double p = test::sidak(level, 3 * truth.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const test::Estimate& e = estimate[i][size_t(c)];
      const double away = std::max(0.0, std::abs(e.mean() - truth[i][c]) - bias * truth[i][c]);
      if (away > 0.0) largest = std::max(largest, away / (1.25 * e.standard_error()));
    }
  EXPECT_GT(test::two_sided_p(largest), p) << largest << " standard errors";
}

// ---- the ledger

TEST(Stochastic, LedgerBalancesToTheLastBit) {
  std::deque<Problem> problems;
  problems.emplace_back(coloured_cube(), 200);
  problems.emplace_back(test::plates(0.3f, 0.9f), 50);
  problems.emplace_back(mirror_room(), 200);
  problems.emplace_back(test::lit_room(), 500);  // lamp, boxes, buried parts
  problems.emplace_back(test::concentric_spheres(0.7f), 100);
  for (Problem& problem : problems) {
    problem.light_unevenly();
    for (const int reflections : {-1, 0, 1, 3})
      for (const bool more : {false, true}) {
        StochasticOptions options = options_for(7.3, 5, 0.1);
        options.max_reflections = reflections;
        options.until_relative_error = more && reflections != 3;
        const StochasticResult result = problem.solve(options);
        EXPECT_TRUE(result.audit.balances());
        for (int c = 0; c < 3; ++c) {
          EXPECT_GT(result.audit.emitted[size_t(c)], 1'000'000'000'000);
          EXPECT_GE(result.audit.absorbed[size_t(c)], 0);
          EXPECT_GE(result.audit.escaped[size_t(c)], 0);
          EXPECT_GE(result.audit.unshot[size_t(c)], 0);
          // Only rounding down is lost at the start.
          double watts = 0.0;
          for (std::uint32_t i = 0; i < problem.mesh.count(); ++i)
            watts += problem.reflectance(i)[c] * problem.mesh.area(i) * double(problem.direct[i][c]);
          const double emitted = double(result.audit.emitted[size_t(c)]) * result.audit.watts_per_unit[c];
          EXPECT_NEAR(emitted / watts, 1.0, 1e-7);
        }
      }
  }
}

TEST(Stochastic, PowerGoesWhereItCan) {
  const StochasticResult open = Problem(test::plates(1.0f, 0.5f), 50).solve(options_for(64));
  EXPECT_GT(open.audit.escaped[0], open.audit.emitted[0] / 2);
  const StochasticResult closed = Problem(coloured_cube(), 200).light_unevenly().solve(options_for(64));
  // Through the edges where shapes meet: fewer than one ray in 100,000.
  EXPECT_LT(closed.audit.escaped[1], closed.audit.emitted[1] / 50000);
}

TEST(Stochastic, IsTheSameBitForBitOnAnyNumberOfThreads) {
  Problem problem(mirror_room(), 300);
  problem.light_unevenly();
  problem.direct[1] = C3f(1e5f);  // shoots thousands of rays at once
  for (const int reflections : {-1, 2}) {
    StochasticOptions options = options_for(40, 3);
    options.max_reflections = reflections;
    const auto run = [&](int threads) {
      const ThreadLimit limit(threads);
      return problem.solve(options);
    };
    const StochasticResult one = run(1);
    for (const int threads : {2, 3, 8}) {
      const StochasticResult other = run(threads);
      EXPECT_EQ(one.irradiance, other.irradiance);
      EXPECT_EQ(one.audit.absorbed, other.audit.absorbed);
      EXPECT_EQ(one.audit.escaped, other.audit.escaped);
      EXPECT_EQ(one.rays, other.rays);
      EXPECT_EQ(one.noise, other.noise);
    }
    options.seed = 4;
    EXPECT_NE(one.irradiance, problem.solve(options).irradiance);
  }
}

// ---- closed forms

// In a closed room of one albedo, whatever the form factors: P = rho (Phi + P - unshot - escaped), Phi the
// direct power, so the ledger says the total to the rounding of single precision.
TEST(Stochastic, PowerOfAFurnaceIsExact) {
  for (const float rho : {0.1f, 0.5f, 0.9f, 0.999f, 1.0f}) {
    Problem problem(test::lit_cube(rho), 60);
    problem.light_unevenly();
    const StochasticResult result = problem.solve(options_for(20, 1, 0.02));
    EXPECT_TRUE(result.audit.balances());
    const double albedo = static_cast<double>(std::min(rho, largest_reflectance));
    for (int c = 0; c < 3; ++c) {
      double direct = 0.0, power = 0.0;
      for (std::uint32_t i = 0; i < problem.mesh.count(); ++i) {
        direct += problem.mesh.area(i) * double(problem.direct[i][c]);
        power += albedo * problem.mesh.area(i) * double(problem.direct[i][c] + result.irradiance[i][c]);
      }
      const double lost = double(result.audit.unshot[size_t(c)] + result.audit.escaped[size_t(c)]) *
                          result.audit.watts_per_unit[c];
      EXPECT_NEAR(power * (1.0 - albedo) / (albedo * (direct - lost)), 1.0, 2e-5) << rho;
      // And the whole solution to what the bound allows: a tenth of the error asked for.
      const double whole = albedo * direct / (1.0 - albedo);
      EXPECT_GE(power, whole * (1.0 - 0.002) - albedo * lost / (1.0 - albedo));
    }
    EXPECT_LE(result.error_bound - result.noise, 0.1 * 0.02);
  }
}

// Every element of the inside of a sphere sees any other by its share of the area: the irradiance is the same
// everywhere, <rho H> / (1 - <rho>), whatever is lit.
TEST(Stochastic, InsideOfASphereIsUniform) {
  SceneDescription description;
  test::add_diffuse(description, "sphere", Sphere{V3f(1.0f, -2.0f, 3.0f), 2.0f, true}, C3f(0.8f, 0.5f, 0.2f));
  Problem problem(std::move(description), 32);
  problem.light_unevenly();
  C3d mean(0.0);
  double area = 0.0;
  for (std::uint32_t i = 0; i < problem.mesh.count(); ++i) {
    mean += problem.reflectance(i) * C3d(problem.direct[i]) * problem.mesh.area(i);
    area += problem.mesh.area(i);
  }
  C3d truth;
  const C3d rho = problem.reflectance(0);
  for (int c = 0; c < 3; ++c) truth[c] = mean[c] / area / (1.0 - rho[c]);
  expect_mean(replicate(problem, options_for(64), 40), std::vector<C3d>(problem.mesh.count(), truth), 1e-4);
}

// Two unit squares of two elements each against linear algebra with the exact factors.
TEST(Stochastic, AgreesWithExactFormFactorsInTheOpen) {
  const Problem problem(test::plates(0.5f, 0.8f), 36);
  const SolverResult truth = solve_lu(problem.exact_balance());
  expect_mean(replicate(problem, options_for(64), 40), truth.irradiance, 1e-4);
}

TEST(Stochastic, AgreesWithExactFormFactorsInAClosedRoom) {
  Problem problem(coloured_cube(), 60);
  problem.light_unevenly();
  const SolverResult truth = solve_lu(problem.exact_balance());
  expect_mean(replicate(problem, options_for(64), 40), truth.irradiance, 1e-4);
  StochasticOptions independent = options_for(64);
  independent.stratified = false;
  expect_mean(replicate(problem, independent, 40), truth.irradiance, 1e-4);
}

// (R20): a limited number of reflections is that many terms of the series.
TEST(Stochastic, LimitedDepthIsThatOfTheSeries) {
  Problem problem(coloured_cube(), 60);
  problem.light_unevenly();
  const Balance balance = problem.exact_balance();
  for (const int reflections : {0, 1, 2}) {
    StochasticOptions options = options_for(64);
    options.max_reflections = reflections;
    const auto estimate = replicate(problem, options, reflections == 0 ? 2 : 40);
    const SolverResult truth = solve_series(balance, reflections);
    if (reflections == 0)
      for (const auto& e : estimate) EXPECT_EQ(e[0].mean() + e[1].mean() + e[2].mean(), 0.0);
    else
      expect_mean(estimate, truth.irradiance, 0.0);
    EXPECT_EQ(problem.solve(options).iterations, std::size_t(reflections));
  }
}

// ---- against other methods

// The balance as the method of rays estimates it, without enforcing what it knows of its sums.
Balance balance_by_rays(const Problem& problem, std::uint32_t rays, std::uint32_t seed) {
  Balance balance;
  RaySurvey survey = survey_with_rays(problem.scene, problem.mesh, rays, seed);
  balance.exchange = exchange_from_landings(survey, problem.mesh);
  balance.specular = std::move(survey.specular);
  for (std::uint32_t i = 0; i < problem.mesh.count(); ++i) {
    balance.area.push_back(problem.mesh.area(i));
    balance.reflectance.push_back(C3f(problem.reflectance(i)));
    balance.direct.emplace_back(problem.direct[i]);
  }
  return balance;
}

template <class Irradiance>
void add_to_shapes(const Problem& problem, const Irradiance& irradiance,
                   std::vector<test::Estimate>& estimate) {
  std::vector<double> power(problem.scene.shapes().size(), 0.0);
  for (std::uint32_t i = 0; i < problem.mesh.count(); ++i)
    power[problem.mesh.root(i).shape] += problem.mesh.area(i) * double(irradiance[i].x + irradiance[i].y);
  estimate.resize(power.size());
  for (std::size_t s = 0; s < power.size(); ++s) estimate[s].add(power[s]);
}

// Mirrors and glass, a black lamp, elements that lie half under others: the power that arrives at each shape.
TEST(Stochastic, AgreesWithTheMethodOfRays) {
  std::deque<Problem> problems;
  problems.emplace_back(mirror_room(), 150);
  problems.emplace_back(test::lit_room(), 250);
  for (Problem& problem : problems) {
    problem.mesh.expose(survey_with_rays(problem.scene, problem.mesh, 1024, 77).exposed);
    problem.light_unevenly();
    std::vector<test::Estimate> gathered, shot;
    for (std::uint32_t seed = 0; seed < 12; ++seed) {
      const Balance balance = balance_by_rays(problem, 256, seed);
      add_to_shapes(problem, solve_gauss_seidel(balance, {1e-4}).irradiance, gathered);
      add_to_shapes(problem, problem.solve(options_for(64, seed)).irradiance, shot);
    }
    for (std::size_t s = 0; s < shot.size(); ++s) {
      const double error = std::hypot(gathered[s].standard_error(), shot[s].standard_error());
      // Five standard errors of about 20 degrees of freedom: less than 1e-3 for all shapes together. The rest
      // is for the light not shot and for what the other method's noise does on average.
      EXPECT_NEAR(shot[s].mean(), gathered[s].mean(), 5.0 * error + 1e-3 * gathered[s].mean())
          << problem.scene.shapes()[s].name;
      EXPECT_LE(error, 0.04 * gathered[s].mean());
    }
  }
}

// A perfect mirror doubles the room: mean radiosities of the cube with one mirror wall are those of the box
// [-1, 1] x [0, 1] x [0, 1], converged.
TEST(Stochastic, MirrorDoublesTheRoom) {
  SceneDescription description = test::lit_cube(0.5f);
  description.materials[2] = one_sided("mirror", Conductor{});
  Problem problem(std::move(description), 1000);
  const Polygon ceiling = test::parallelogram(V3d(-1, 0, 1), V3d(0, 1, 0), V3d(2, 0, 0));
  for (std::uint32_t i = 0; i < problem.mesh.count(); ++i)
    problem.direct[i] = C3f(static_cast<float>(exchange_exact(problem.mesh.patch(i).polygon(), ceiling, 1e-4) /
                                               problem.mesh.area(i)));
  const StochasticResult result = problem.solve(options_for(256));
  std::array<double, 6> radiosity{};
  for (std::uint32_t i = 0; i < problem.mesh.count(); ++i)
    radiosity[problem.mesh.root(i).shape] +=
        0.5 * problem.mesh.area(i) * double(problem.direct[i].x + result.irradiance[i].x);
  // 0.3 % for the elements' size and five standard deviations of 0.1 %.
  EXPECT_NEAR(radiosity[0] / 0.230122, 1.0, 0.008);
  EXPECT_NEAR(radiosity[1] / 0.12036, 1.0, 0.008);
  EXPECT_NEAR(radiosity[3] / 0.212382, 1.0, 0.008);
  EXPECT_NEAR((radiosity[4] + radiosity[5]) / (2 * 0.218567), 1.0, 0.008);
}

TEST(Stochastic, IsWiredIntoTheSolution) {
  const Scene scene(test::lit_room());
  RadiosityOptions options;
  options.max_elements = 400;
  options.relative_error = 0.05;
  options.rays_per_element = 512;
  const Solution truth = solve_radiosity(scene, options);
  options.solver = Solver::stochastic;
  options.form_factors = FormFactorMethod::rays;  // allowed: it casts nothing else
  options.rays_per_element = 0;
  const Solution solution = solve_radiosity(scene, options);
  const RadiosityStats& stats = solution.stats();
  EXPECT_EQ(stats.solver, "stochastic");
  EXPECT_EQ(stats.form_factors, "none");
  EXPECT_EQ(stats.links, 0u);
  EXPECT_TRUE(stats.closed);
  EXPECT_LE(stats.error_bound, 0.05);
  EXPECT_GT(stats.error_bound, 0.01);
  EXPECT_GT(stats.iterations, 5u);
  EXPECT_GT(stats.memory_bytes, stochastic_bytes_per_element * stats.elements);
  double difference = 0.0, total = 0.0;
  for (std::uint32_t i = 0; i < solution.mesh().count(); ++i) {
    difference += solution.mesh().area(i) * std::abs(double(solution.irradiances()[i].total().x) -
                                                     double(truth.irradiances()[i].total().x));
    total += solution.mesh().area(i) * double(truth.irradiances()[i].total().x);
  }
  // The other method's noise is less than what is allowed here.
  EXPECT_LT(difference / total, 0.05 + 0.02);
  options.form_factors = FormFactorMethod::exact;
  EXPECT_THROW(solve_radiosity(scene, options), Error);
}

TEST(Stochastic, DarkEmptyAndDegenerateScenesAreNoTrouble) {
  Problem dark(test::lit_cube(0.5f), 60);
  dark.direct.assign(dark.mesh.count(), C3f(0.0f));
  const StochasticResult night = dark.solve(options_for(16));
  EXPECT_EQ(night.shots, 0u);
  EXPECT_EQ(night.error_bound, 0.0);
  EXPECT_EQ(night.irradiance, std::vector<C3f>(dark.mesh.count(), C3f(0.0f)));
  EXPECT_TRUE(Problem(SceneDescription{}, 10).solve(options_for(16)).irradiance.empty());

  // A triangle on its own, and one without area.
  SceneDescription lone;
  Mesh triangle;
  triangle.positions = {V3f(0.0f), V3f(1, 0, 0), V3f(0, 1, 0), V3f(2.0f), V3f(4.0f)};
  triangle.triangles = {V3u(0, 1, 2), V3u(0, 3, 4)};
  test::add_diffuse(lone, "triangle", triangle, C3f(0.5f));
  const Problem problem(std::move(lone), 1);
  ASSERT_EQ(problem.mesh.count(), 2u);
  StochasticOptions options = options_for(100);
  options.until_relative_error = true;
  const StochasticResult result = problem.solve(options);
  EXPECT_EQ(result.irradiance, std::vector<C3f>(2, C3f(0.0f)));
  EXPECT_TRUE(result.audit.balances());
  EXPECT_EQ(result.audit.escaped, result.audit.emitted);
  EXPECT_GE(result.shots, 50u);

  // An element of which hardly anything is exposed has no area: it only absorbs.
  Problem covered(test::lit_cube(0.5f), 60);
  std::vector<float> exposed(covered.mesh.count(), 1.0f);
  exposed[3] = 0.0f;
  covered.mesh.expose(exposed);
  const StochasticResult rest = covered.solve(options_for(64));
  EXPECT_EQ(rest.irradiance[3], C3f(0.0f));
  EXPECT_TRUE(rest.audit.balances());
}

// No power and no channel is small or large in itself.
TEST(Stochastic, ScalesWithPower) {
  Problem problem(coloured_cube(), 60);
  problem.light_unevenly();
  const StochasticResult one = problem.solve(options_for(32));
  for (C3f& direct : problem.direct) direct = C3f(direct.x * 0x1p-60f, direct.y * 0x1p60f, direct.z);
  const StochasticResult other = problem.solve(options_for(32));
  EXPECT_EQ(one.audit.absorbed, other.audit.absorbed);
  for (std::size_t i = 0; i < one.irradiance.size(); ++i) {
    EXPECT_EQ(one.irradiance[i].x * 0x1p-60f, other.irradiance[i].x);
    EXPECT_EQ(one.irradiance[i].y * 0x1p60f, other.irradiance[i].y);
    EXPECT_EQ(one.irradiance[i].z, other.irradiance[i].z);
  }
}

TEST(Stochastic, CanBeInterrupted) {
  const Problem problem(test::lit_cube(0.5f), 60);
  interrupt_requested() = true;
  EXPECT_THROW(problem.solve(options_for(16)), Interrupted);
  interrupt_requested() = false;
}

// ---- noise

struct Noise {
  double of_law = 0.0;      // Sum over elements of sample variance over that of (R29), over the elements
  double worst_p = 1.0;     // of the elements' chi-squares, two-sided
  double mean_error = 0.0;  // Sum A rho |error| over the power, mean over seeds
  double predicted = 0.0;   // (R30)
};

Noise measure_noise(const Problem& problem, StochasticOptions options, std::uint32_t seeds) {
  const SolverResult truth = solve_lu(problem.exact_balance());
  std::vector<test::Estimate> estimate(problem.mesh.count());
  double power = 0.0, error = 0.0, shots = 0.0;
  Noise noise;
  for (options.seed = 1; options.seed <= seeds; ++options.seed) {
    const StochasticResult result = problem.solve(options);
    noise.predicted += result.noise / seeds;
    shots += double(result.shots) / seeds;
    for (std::uint32_t i = 0; i < problem.mesh.count(); ++i) {
      const double weight = problem.mesh.area(i) * problem.reflectance(i).x / seeds;
      estimate[i].add(double(result.irradiance[i].x));
      error += weight * std::abs(double(result.irradiance[i].x) - truth.irradiance[i].x);
      power += weight * (double(problem.direct[i].x) + truth.irradiance[i].x);
    }
  }
  noise.mean_error = error / power;
  for (std::uint32_t i = 0; i < problem.mesh.count(); ++i) {
    const double law = power * truth.irradiance[i].x / (problem.mesh.area(i) * shots);
    const double ratio = estimate[i].variance() / law, p = test::chi2_p(ratio * (seeds - 1), seeds - 1);
    noise.of_law += ratio / double(problem.mesh.count());
    noise.worst_p = std::min(noise.worst_p, 2.0 * std::min(p, 1.0 - p));
  }
  return noise;
}

// (R29) and (R30) hold for independent random numbers; stratified ones have less noise, so that they stay on
// the safe side.
TEST(Stochastic, NoiseFollowsTheVarianceLaw) {
  const Problem problem(test::lit_cube(0.7f), 100);
  constexpr std::uint32_t seeds = 80;
  StochasticOptions options = options_for(128, 0, 0.05);
  options.stratified = false;
  const Noise independent = measure_noise(problem, options, seeds);
  // 8000 squares have a relative standard deviation of 1.6 %, without what the law leaves out.
  EXPECT_NEAR(independent.of_law, 1.0, 0.08);
  EXPECT_GT(independent.worst_p, test::sidak(1e-3, problem.mesh.count()));
  // The mean of a normal variable's absolute value is 0.8 standard deviations.
  EXPECT_NEAR(independent.mean_error / independent.predicted, std::sqrt(2.0 / pi), 0.04);

  options.stratified = true;
  const Noise stratified = measure_noise(problem, options, seeds);
  EXPECT_LT(stratified.of_law, 0.9 * independent.of_law);
  EXPECT_LT(stratified.mean_error, stratified.predicted);
  EXPECT_NEAR(stratified.predicted / independent.predicted, 1.0, 0.02);
}

// Four times the rays, half the noise (stratified: a little less than that).
TEST(Stochastic, NoiseFallsAsPredicted) {
  const Problem problem(test::lit_cube(0.7f), 100);
  Noise last;
  for (const double rays : {16.0, 64.0, 256.0}) {
    const Noise noise = measure_noise(problem, options_for(rays, 0, 0.02), 12);
    EXPECT_LT(noise.mean_error, noise.predicted);
    if (last.mean_error > 0.0) {
      EXPECT_NEAR(noise.predicted / last.predicted, 0.5, 0.05);
      EXPECT_LT(noise.mean_error / last.mean_error, 0.55);
    }
    last = noise;
  }
}

TEST(Stochastic, ShootsAsManyRaysAsAskedFor) {
  for (const float rho : {0.2f, 0.7f})
    for (const float distance : {0.1f, 1.0f}) {
      const Problem problem(test::plates(distance, rho), 300);
      const StochasticResult result = problem.solve(options_for(64, 0, 0.05));
      const double mean = double(result.shots) / double(problem.mesh.count());
      EXPECT_GT(mean, 0.9 * 64);
      EXPECT_LT(mean, 1.2 * 64);  // the last of the light
    }
}

TEST(Stochastic, GoesOnUntilTheErrorIsMet) {
  Problem problem(coloured_cube(), 100);
  problem.light_unevenly();
  const SolverResult truth = solve_lu(problem.exact_balance());
  for (const int reflections : {-1, 2})
    for (const double error : {0.1, 0.03}) {
      StochasticOptions options = options_for(4, 1, error);
      options.until_relative_error = true;
      options.max_reflections = reflections;
      const StochasticResult result = problem.solve(options);
      EXPECT_LE(result.error_bound, error);
      EXPECT_GT(result.error_bound, 0.5 * error);
      if (reflections >= 0) continue;
      for (int c = 0; c < 3; ++c) {
        double difference = 0.0, power = 0.0;
        for (std::uint32_t i = 0; i < problem.mesh.count(); ++i) {
          const double weight = problem.mesh.area(i) * problem.reflectance(i)[c];
          difference += weight * std::abs(double(result.irradiance[i][c]) - truth.irradiance[i][c]);
          power += weight * (double(problem.direct[i][c]) + truth.irradiance[i][c]);
        }
        EXPECT_LT(difference / power, error);
      }
    }
}

}  // namespace
}  // namespace twopass
