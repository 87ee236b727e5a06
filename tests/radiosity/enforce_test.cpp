#include "radiosity/enforce.h"

#include <gtest/gtest.h>

#include "tests/radiosity/random_balance.h"

namespace twopass {
namespace {

bool is_symmetric(const ExchangeMatrix& exchange) {
  const ExchangeMatrix transposed = exchange.transpose();
  return Eigen::MatrixXf(exchange) == Eigen::MatrixXf(transposed);
}

TEST(Enforce, ClosesAnEstimateAndKeepsItSymmetric) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Balance balance = test::random_balance(60, 1.0, false, seed);
    // Areas for which a solution is near: the rows' own sums, disturbed.
    std::vector<double> target = row_sums(balance.exchange), fixed(60, 0.0);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.8, 1.25);
    for (double& t : target) t *= uniform(random);
    EXPECT_LT(scale_to_row_sums(balance.exchange, fixed, target, target, 1e-7), 1e-7);
    const std::vector<double> sum = row_sums(balance.exchange);
    for (std::size_t i = 0; i < sum.size(); ++i) EXPECT_NEAR(sum[i] / target[i], 1.0, 1e-6);
    EXPECT_TRUE(is_symmetric(balance.exchange));
  }
}

TEST(Enforce, CountsWhatIsExchangedWithOthers) {
  Balance balance = test::random_balance(40, 1.0, false, 1);
  const std::vector<double> sum = row_sums(balance.exchange);
  std::vector<double> fixed(40), target(40);
  for (std::size_t i = 0; i < 40; ++i) {
    fixed[i] = 0.1 * sum[i];
    target[i] = sum[i];
  }
  const ExchangeMatrix before = balance.exchange;
  EXPECT_LT(scale_to_row_sums(balance.exchange, fixed, target, target, 1e-6), 1e-6);
  // d (x d + 0.1 x) = x for every row: d = (sqrt(4.01) - 0.1) / 2.
  const double d = (std::sqrt(4.01) - 0.1) / 2.0;
  EXPECT_LT((Eigen::MatrixXf(balance.exchange) - Eigen::MatrixXf(before) * float(d * d)).cwiseAbs().maxCoeff(),
            1e-6f);
}

TEST(Enforce, LeavesTheImpossibleWithinReason) {
  // Two elements that see only each other cannot have different sums.
  ExchangeMatrix exchange(2, 2);
  exchange.insert(0, 1) = 1.0f;
  exchange.insert(1, 0) = 1.0f;
  const std::vector<double> fixed{0.0, 0.0}, target{1.0, 2.0}, area{1.0, 2.0};
  EXPECT_GT(scale_to_row_sums(exchange, fixed, target, area, 1e-6), 0.1);
  EXPECT_TRUE(is_symmetric(exchange));
  EXPECT_GE(exchange.coeff(0, 1), 1.0f);
  EXPECT_LE(exchange.coeff(0, 1), 2.0f);
}

TEST(Enforce, CapsSumsAndOnlyEverReduces) {
  Balance balance = test::random_balance(50, 1.0, false, 9);
  const ExchangeMatrix before = balance.exchange;
  std::vector<double> limit = row_sums(before);
  for (std::size_t i = 0; i < limit.size(); ++i) limit[i] *= i % 3 ? 1.1 : 0.7;
  cap_row_sums(balance.exchange, limit);
  const std::vector<double> sum = row_sums(balance.exchange);
  for (std::size_t i = 0; i < limit.size(); ++i) EXPECT_LE(sum[i], limit[i] * (1.0 + 1e-6));
  EXPECT_LE((Eigen::MatrixXf(balance.exchange) - Eigen::MatrixXf(before)).maxCoeff(), 0.0f);
  EXPECT_TRUE(is_symmetric(balance.exchange));
}

}  // namespace
}  // namespace twopass
