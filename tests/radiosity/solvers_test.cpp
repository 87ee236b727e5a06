#include "radiosity/solvers.h"

#include <gtest/gtest.h>

#include "radiosity/form_factor_pair.h"
#include "render/core/error.h"
#include "tests/radiosity/polygon_samples.h"
#include "tests/radiosity/random_balance.h"

namespace twopass {
namespace {

using test::parallelogram;

double worst_relative_difference(const Balance& balance, const SolverResult& result,
                                 const SolverResult& truth) {
  const C3d difference = test::power_difference(balance, result.radiosity, truth.radiosity);
  const C3d power =
      test::power_difference(balance, result.radiosity, std::vector<C3d>(balance.area.size(), C3d(0.0)));
  double worst = 0.0;
  for (int c = 0; c < 3; ++c)
    if (power[c] > 0.0) worst = std::max(worst, difference[c] / power[c]);
  return worst;
}

TEST(Solvers, AgreeWithEliminationWithinTheirBounds) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    const Balance balance = test::random_balance(3 + int(seed) % 40, seed % 3 ? 1.0 : 0.8, seed % 2, seed);
    const SolverResult truth = solve_lu(balance);
    EXPECT_LT(truth.error.residual, 1e-12);
    for (const double accuracy : {0.1, 1e-2, 1e-6})
      for (auto* solver : {solve_gauss_seidel, solve_progressive}) {
        const SolverResult result = solver(balance, {accuracy});
        EXPECT_LE(result.error.bound, accuracy);
        // (R16): rounding of the oracle itself is far below the bounds asked for.
        EXPECT_LE(worst_relative_difference(balance, result, truth), result.error.bound + 1e-12) << seed;
      }
  }
}

TEST(Solvers, BoundHoldsAfterEveryNumberOfIterations) {
  for (unsigned seed = 100; seed < 130; ++seed) {
    const Balance balance = test::random_balance(20, 1.0, seed % 2, seed);
    const SolverResult truth = solve_lu(balance);
    for (std::size_t iterations = 0; iterations < 12; ++iterations)
      for (auto* solver : {solve_gauss_seidel, solve_progressive}) {
        const SolverResult result = solver(balance, {0.0, iterations});
        EXPECT_EQ(result.iterations, iterations);
        EXPECT_LE(worst_relative_difference(balance, result, truth), result.error.bound * (1 + 1e-9) + 1e-12);
      }
  }
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
  for (const SolverResult& result :
       {solve_lu(balance), solve_gauss_seidel(balance, {1e-6}), solve_progressive(balance, {1e-6})})
    for (const C3d& radiosity : result.radiosity)
      for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(radiosity[c]));
  balance.direct.assign(10, C3d(0.0));
  EXPECT_EQ(solve_gauss_seidel(balance, {1e-6}).iterations, 0u);
  EXPECT_EQ(solve_progressive(balance, {1e-6}).error.bound, 0.0);
}

TEST(Solvers, EliminationRefusesWhatItCannotHandle) {
  Balance balance;
  balance.area.assign(lu_max_elements + 1, 1.0);
  EXPECT_THROW(solve_lu(balance), Error);
}

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

TEST(Solvers, SolveTheCubeOfSixElements) {
  const Balance cube = cube_of_six(0.5f);
  for (const SolverResult& result :
       {solve_lu(cube), solve_gauss_seidel(cube, {1e-9}), solve_progressive(cube, {1e-9})}) {
    // The exchange is stored in single precision.
    EXPECT_NEAR(result.radiosity[0].x, 0.090909098, 1e-7);
    EXPECT_NEAR(result.radiosity[1].x, 0.181745826108, 1e-7);
    for (int wall = 2; wall < 6; ++wall) EXPECT_NEAR(result.radiosity[size_t(wall)].x, 0.181836268946, 1e-7);
  }
}

}  // namespace
}  // namespace twopass
