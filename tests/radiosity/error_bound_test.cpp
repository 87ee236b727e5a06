#include "radiosity/error_bound.h"

#include <gtest/gtest.h>

#include "radiosity/solvers.h"
#include "tests/radiosity/random_balance.h"

namespace twopass {
namespace {

TEST(ErrorBound, ContractionsAreAtMostTheLargestReflectance) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Balance balance = test::random_balance(30, 1.0, false, seed);
    C3f largest(0.0f);
    for (const C3f& rho : balance.reflectance)
      for (int c = 0; c < 3; ++c) largest[c] = std::max(largest[c], rho[c]);
    const Contraction q = contraction(balance);
    for (int c = 0; c < 3; ++c) {
      EXPECT_LE(q.by_maximum[c], double(largest[c]) + 1e-6);
      EXPECT_LE(q.by_power[c], double(largest[c]) + 1e-6);
    }
  }
}

// (R16) for guesses that no solver would make.
TEST(ErrorBound, HoldsForAnyGuess) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const Balance balance = test::random_balance(3 + int(seed) % 30, 0.95, seed % 2, seed);
    const SolverResult truth = solve_lu(balance);
    std::vector<C3d> guess = truth.radiosity;
    const double spread = std::pow(10.0, -int(seed % 7));
    for (C3d& b : guess)
      for (int c = 0; c < 3; ++c) b[c] = std::abs(b[c] + spread * normal(random));
    const BalanceError error = balance_error(balance, contraction(balance), guess, balance.gather_all(guess));
    const C3d difference = test::power_difference(balance, guess, truth.radiosity);
    const C3d power = test::power_difference(balance, guess, std::vector<C3d>(guess.size(), C3d(0.0)));
    for (int c = 0; c < 3; ++c) EXPECT_LE(difference[c], power[c] * error.bound * (1.0 + 1e-9)) << seed;
    EXPECT_TRUE(std::isfinite(error.bound));
  }
}

TEST(ErrorBound, IsTightWhereAllElementsAreAlike) {
  Balance balance;
  balance.area = {1.0, 1.0};
  balance.reflectance = {C3f(0.5f), C3f(0.5f)};
  balance.direct = {C3d(1.0), C3d(1.0)};
  balance.exchange.resize(2, 2);
  balance.exchange.insert(0, 1) = 1.0f;
  balance.exchange.insert(1, 0) = 1.0f;
  // B = 0.5 (1 + B) = 1; a guess of 0.9 has the relative error 1/9.
  const std::vector<C3d> guess(2, C3d(0.9));
  EXPECT_NEAR(balance_error(balance, contraction(balance), guess, balance.gather_all(guess)).bound, 1.0 / 9.0,
              1e-12);
}

TEST(ErrorBound, PromisesNothingWithoutContraction) {
  EXPECT_EQ(error_from_residual(1.0, 1.5, 1.0, 1.0, 1.0), std::numeric_limits<double>::infinity());
  EXPECT_DOUBLE_EQ(error_from_residual(1.5, 0.5, 1.0, 0.25, 8.0), 4.0);
}

}  // namespace
}  // namespace twopass
