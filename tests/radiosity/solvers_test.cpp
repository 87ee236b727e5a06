#include "radiosity/solvers.h"

#include <gtest/gtest.h>

#include "radiosity/form_factor_pair.h"
#include "render/core/error.h"
#include "tests/radiosity/polygon_samples.h"
#include "tests/radiosity/random_balance.h"

namespace twopass {
namespace {

using test::parallelogram;

struct Iteration {
  std::string_view name;
  SolverResult (*solve)(const Balance&, const StopRule&);
};

constexpr Iteration iterations_of_all_kinds[] = {
    {"jacobi", solve_jacobi},
    {"gauss-seidel", solve_gauss_seidel},
    {"cg", solve_cg},
    {"progressive",
     [](const Balance& balance, const StopRule& stop) { return solve_progressive(balance, stop); }},
    {"overshooting",
     [](const Balance& balance, const StopRule& stop) { return solve_progressive(balance, stop, true); }},
};

// The unit cube with one square element a face and a ceiling of exitance 1: linear algebra with exact factors.
Balance cube_of_six(float reflectance) {
  const V3d o(0.0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const std::array<Polygon, 6> face{parallelogram(z, y, x), parallelogram(o, x, y), parallelogram(o, y, z),
                                    parallelogram(x, z, y), parallelogram(o, z, x), parallelogram(y, x, z)};
  Balance balance;
  balance.area.assign(6, 1.0);
  balance.reflectance.assign(6, C3f(reflectance));
  Eigen::MatrixXf exchange = Eigen::MatrixXf::Zero(6, 6);
  for (int i = 0; i < 6; ++i) {
    balance.direct.emplace_back(exchange_exact(face[size_t(i)], face[0], 1e-12));
    for (int j = 0; j < 6; ++j)
      exchange(i, j) = static_cast<float>(exchange_exact(face[size_t(i)], face[size_t(j)], 1e-12));
  }
  balance.exchange = exchange.sparseView();
  return balance;
}

// Sum A |error| / Sum A B of the worst channel: what BalanceError::bound bounds.
double worst_relative_difference(const Balance& balance, const SolverResult& result,
                                 const SolverResult& truth) {
  const C3d difference = test::power_difference(balance, result.radiosity, truth.radiosity);
  C3d power(0.0);
  for (std::uint32_t i = 0; i < balance.count(); ++i) power += result.radiosity[i] * balance.area[i];
  double worst = 0.0;
  for (int c = 0; c < 3; ++c)
    if (difference[c] > 0.0)
      worst =
          std::max(worst, power[c] > 0.0 ? difference[c] / power[c] : std::numeric_limits<double>::infinity());
  return worst;
}

TEST(Solvers, AgreeWithEliminationWithinTheirBounds) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    Balance balance = test::random_balance(3 + int(seed) % 40, seed % 3 ? 1.0 : 0.8, seed % 2, seed);
    if (seed % 5 == 0) test::bury(balance, 1);
    if (seed % 7 == 0) balance.reflectance[2] = C3f(0.0f);
    const SolverResult truth = solve_lu(balance);
    EXPECT_LT(truth.error.residual, 1e-12);
    for (const double accuracy : {0.1, 1e-2, 1e-6})
      for (const Iteration& iteration : iterations_of_all_kinds) {
        const SolverResult result = iteration.solve(balance, {accuracy});
        EXPECT_LE(result.error.bound, accuracy);
        // (R16): rounding of the oracle itself is far below the bounds asked for.
        EXPECT_LE(worst_relative_difference(balance, result, truth), result.error.bound + 1e-12)
            << iteration.name << " " << seed;
      }
  }
}

// The albedos of a dim, a bright and an all but white room, closed, where nothing but them ends the light; and
// half of it over specular links, which are not symmetric.
TEST(Solvers, AgreeWithEliminationAtEveryAlbedo) {
  for (const float albedo : {0.5f, 0.95f, 0.999f})
    for (const bool specular : {false, true})
      for (unsigned seed = 0; seed < 3; ++seed) {
        Balance balance = test::closed_balance(12, albedo, specular, seed);
        if (seed == 1) test::bury(balance, 3);
        if (seed == 2) balance.reflectance[5] = C3f(0.0f, albedo, 0.5f * albedo);
        const SolverResult truth = solve_lu(balance);
        for (const Iteration& iteration : iterations_of_all_kinds) {
          const SolverResult result = iteration.solve(balance, {1e-7});
          EXPECT_LE(result.error.bound, 1e-7);
          EXPECT_LE(worst_relative_difference(balance, result, truth), 1.001e-7)
              << iteration.name << " " << albedo << " " << seed;
          for (std::uint32_t i = 0; i < balance.count(); ++i)
            EXPECT_EQ(result.irradiance[i], balance.gather(i, result.radiosity));
        }
      }
}

TEST(Solvers, BoundHoldsAfterEveryNumberOfIterations) {
  for (unsigned seed = 100; seed < 130; ++seed) {
    const Balance balance = test::random_balance(20, 1.0, seed % 2, seed);
    const SolverResult truth = solve_lu(balance);
    for (std::size_t iterations = 0; iterations < 12; ++iterations)
      for (const Iteration& iteration : iterations_of_all_kinds) {
        const SolverResult result = iteration.solve(balance, {0.0, iterations});
        EXPECT_EQ(result.iterations, iterations) << iteration.name;
        EXPECT_LE(worst_relative_difference(balance, result, truth), result.error.bound * (1 + 1e-9) + 1e-12);
      }
  }
}

// (R16) does not ask where an iterate comes from: open and closed, dim and bright, with and without specular
// links, dead and buried elements, stopped anywhere.
TEST(Solvers, BoundHoldsInAThousandBalancesStoppedAnywhere) {
  std::mt19937 random(4711);
  const auto below = [&](unsigned n) { return random() % n; };
  for (unsigned seed = 0; seed < 1000; ++seed) {
    const int n = 3 + int(below(14));
    const bool specular = below(3) == 0;
    Balance balance = seed % 2 ? test::random_balance(n, 0.1 + 0.1 * below(10), specular, seed)
                               : test::closed_balance(n, 1.0f - std::pow(0.1f, 1 + below(3)), specular, seed);
    if (below(4) == 0) test::bury(balance, below(unsigned(n)));
    if (below(3) == 0) balance.reflectance[below(unsigned(n))] = C3f(0.0f);
    const SolverResult truth = solve_lu(balance);
    const std::size_t sweeps = below(20), shots = below(60);
    for (const Iteration& iteration : iterations_of_all_kinds) {
      const bool shoots = iteration.name == "progressive" || iteration.name == "overshooting";
      const SolverResult result = iteration.solve(balance, {1e-13, shoots ? shots : sweeps});
      const double error = worst_relative_difference(balance, result, truth);
      // The oracle's own rounding grows with the condition of the balance, at most 1 / (1 - 0.999).
      EXPECT_LE(error, result.error.bound * (1.0 + 1e-9) + 1e-11) << iteration.name << " " << seed;
      EXPECT_FALSE(std::isnan(result.error.bound));
    }
  }
}

// (R21) is (R20), stopped by the bound.
TEST(Solvers, JacobiIsTheSeries) {
  const Balance balance = test::random_balance(25, 1.0, true, 9);
  for (const std::size_t k : {0, 1, 7}) {
    const SolverResult sweeps = solve_jacobi(balance, {0.0, k}), terms = solve_series(balance, int(k));
    EXPECT_EQ(sweeps.radiosity, terms.radiosity);
  }
}

// Conjugate gradients end after as many steps as the residual has eigenvectors: in the cube lit by its ceiling
// those of ceiling, floor and walls, whatever the albedo.
TEST(Solvers, ConjugateGradientsNeedOneStepForEachEigenvector) {
  for (const float albedo : {0.5f, 0.95f, 0.999f})
    EXPECT_LE(solve_cg(cube_of_six(albedo), {1e-6}).iterations, 3u);
}

// (R22): the error shrinks by (1 - sqrt(1 - rho^2)) / rho a step in the norm of the system, which differs from
// that of the bound by constants: twice as many steps as for the first digits bring at least twice as many.
TEST(Solvers, ConjugateGradientsConvergeAsTheirConditionSays) {
  for (const float albedo : {0.9f, 0.95f, 0.999f}) {
    const Balance balance = test::closed_balance(80, albedo, false, 2);
    const double rho = static_cast<double>(albedo), factor = (1.0 - std::sqrt(1.0 - rho * rho)) / rho;
    const auto coarse = solve_cg(balance, {1e-2}).iterations, fine = solve_cg(balance, {1e-8}).iterations;
    EXPECT_LE(static_cast<double>(fine - coarse), std::log(1e-6 * (1.0 - rho)) / std::log(factor));
    EXPECT_LT(3 * coarse, solve_gauss_seidel(balance, {1e-2}).iterations);
  }
}

// (R23).
TEST(Solvers, OvershootingSavesShotsInBrightRooms) {
  for (const auto& [albedo, saving] : {std::pair(0.5f, 1.5), {0.8f, 2.5}, {0.95f, 6.0}}) {
    const Balance balance = test::closed_balance(100, albedo, false, 1);
    for (const double bound : {1e-2, 1e-8}) {
      const auto without = static_cast<double>(solve_progressive(balance, {bound}).iterations);
      const auto with = static_cast<double>(solve_progressive(balance, {bound}, true).iterations);
      EXPECT_GT(without / with, saving) << albedo << " " << bound;
    }
  }
}

// Without it, every iterate stays below the solution (ShootingNeverOvershoots).
TEST(Solvers, OvershootingOvershootsAndTakesItBack) {
  const Balance balance = test::closed_balance(30, 0.95f, false, 5);
  const SolverResult truth = solve_lu(balance);
  bool above = false;
  for (std::size_t shots = 1; shots < 60; ++shots) {
    const SolverResult early = solve_progressive(balance, {0.0, shots}, true);
    for (std::size_t i = 0; i < truth.radiosity.size(); ++i)
      above = above || early.radiosity[i].x > (1.0 + 1e-6) * truth.radiosity[i].x;
  }
  EXPECT_TRUE(above);
  EXPECT_LT(worst_relative_difference(balance, solve_progressive(balance, {1e-9}, true), truth), 1e-9);
}

// Two rooms that do not see each other, one of them dark and all but white: what is expected everywhere never
// arrives there.
TEST(Solvers, OvershootingConvergesWhereExpectationsAreWrong) {
  Balance balance = test::closed_balance(40, 0.999f, false, 3);
  balance.exchange.prune([](Eigen::Index i, Eigen::Index j, float) { return (i < 20) == (j < 20); });
  for (std::size_t i = 20; i < 40; ++i) balance.direct[i] = C3d(0.0);
  for (std::size_t i = 0; i < 20; ++i) balance.reflectance[i] = C3f(0.3f);
  const SolverResult truth = solve_lu(balance);
  const SolverResult result = solve_progressive(balance, {1e-7}, true);
  EXPECT_LE(worst_relative_difference(balance, result, truth), result.error.bound + 1e-12);
}

// (R20): each term adds one reflection; in a closed room of one albedo rho the power of k of them is a
// geometric sum, and all of them are the solution.
TEST(Solvers, SeriesAddsOneReflectionATerm) {
  const Balance balance = test::random_balance(25, 1.0, false, 9);
  const SolverResult none = solve_series(balance, 0);
  for (std::uint32_t i = 0; i < balance.count(); ++i) {
    EXPECT_EQ(none.irradiance[i], C3d(0.0));
    EXPECT_EQ(none.radiosity[i], C3d(balance.reflectance[i]) * balance.direct[i]);
  }
  const SolverResult one = solve_series(balance, 1);
  const std::vector<C3d> gathered = balance.gather_all(none.radiosity);
  for (std::uint32_t i = 0; i < balance.count(); ++i) EXPECT_EQ(one.irradiance[i], gathered[i]);
  EXPECT_LT(worst_relative_difference(balance, solve_series(balance, 20000), solve_lu(balance)), 1e-9);
}

TEST(Solvers, ShootingNeverOvershoots) {
  const Balance balance = test::random_balance(30, 1.0, true, 5);
  const SolverResult truth = solve_lu(balance);
  for (std::size_t shots : {0, 1, 5, 40, 200}) {
    const SolverResult result = solve_progressive(balance, {0.0, shots});
    for (std::size_t i = 0; i < truth.radiosity.size(); ++i)
      for (int c = 0; c < 3; ++c) EXPECT_LE(result.radiosity[i][c], truth.radiosity[i][c] + 1e-12);
  }
}

// (R19): after a few shots the ambient term brings the picture nearer to the solution.
TEST(Solvers, AmbientTermImprovesAnEarlyPicture) {
  const int n = 40;
  Balance balance;
  balance.area.assign(n, 1.0);
  balance.reflectance.assign(n, C3f(0.8f));
  balance.direct.assign(n, C3d(0.0));
  balance.direct[0] = C3d(1.0);
  balance.exchange = Eigen::MatrixXf::Constant(n, n, 1.0f / n).sparseView();
  const SolverResult truth = solve_lu(balance);
  SolverResult early = solve_progressive(balance, {0.0, 5});
  const double before = test::power_difference(balance, early.radiosity, truth.radiosity).x;
  for (C3d& radiosity : early.radiosity) radiosity += early.ambient * 0.8;
  EXPECT_LT(test::power_difference(balance, early.radiosity, truth.radiosity).x, 0.2 * before);
}

TEST(Solvers, ElementsWithoutAreaAndDarkScenesAreNoTrouble) {
  Balance balance = test::random_balance(10, 0.9, false, 3);
  balance.area[4] = 0.0;
  std::vector<SolverResult> results{solve_lu(balance)};
  for (const Iteration& iteration : iterations_of_all_kinds)
    results.push_back(iteration.solve(balance, {1e-6}));
  for (const SolverResult& result : results)
    for (const C3d& radiosity : result.radiosity)
      for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(radiosity[c]));
  balance.direct.assign(10, C3d(0.0));
  for (const Iteration& iteration : iterations_of_all_kinds) {
    const SolverResult night = iteration.solve(balance, {1e-6});
    EXPECT_EQ(night.iterations, 0u);
    EXPECT_EQ(night.error.bound, 0.0);
    for (const C3d& radiosity : iteration.solve(balance, {-1.0, 5}).radiosity) EXPECT_EQ(radiosity, C3d(0.0));
  }
}

TEST(Solvers, EliminationRefusesWhatItCannotHandle) {
  Balance balance;
  balance.area.assign(lu_max_elements + 1, 1.0);
  EXPECT_THROW(solve_lu(balance), Error);
}

TEST(Solvers, SolveTheCubeOfSixElements) {
  const Balance cube = cube_of_six(0.5f);
  std::vector<SolverResult> results{solve_lu(cube)};
  for (const Iteration& iteration : iterations_of_all_kinds) results.push_back(iteration.solve(cube, {1e-9}));
  for (const SolverResult& result : results) {
    // The exchange is stored in single precision.
    EXPECT_NEAR(result.radiosity[0].x, 0.090909098, 1e-7);
    EXPECT_NEAR(result.radiosity[1].x, 0.181745826108, 1e-7);
    for (int wall = 2; wall < 6; ++wall) EXPECT_NEAR(result.radiosity[size_t(wall)].x, 0.181836268946, 1e-7);
  }
}

}  // namespace
}  // namespace twopass
