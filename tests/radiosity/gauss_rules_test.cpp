#include "radiosity/gauss_rules.h"

#include <cmath>

#include <gtest/gtest.h>

namespace twopass {
namespace {

TEST(GaussRules, LegendreIntegratesPowersExactly) {
  for (int n = 1; n <= GaussRule::max_points; ++n) {
    const GaussRule& rule = gauss_legendre(n);
    ASSERT_EQ(rule.n, n);
    for (int power = 0; power < 2 * n; ++power) {
      double sum = 0.0;
      for (int i = 0; i < n; ++i) sum += rule.w[i] * std::pow(rule.x[i], power);
      EXPECT_NEAR(sum * (power + 1), 1.0, 2e-15 * (power + 1)) << n << " points, power " << power;
    }
  }
}

TEST(GaussRules, JacobiIntegratesPowersTimesOneMinusXExactly) {
  for (int n = 1; n <= GaussRule::max_points; ++n) {
    const GaussRule& rule = gauss_jacobi(n);
    for (int power = 0; power < 2 * n; ++power) {
      double sum = 0.0;
      for (int i = 0; i < n; ++i) sum += rule.w[i] * std::pow(rule.x[i], power);
      EXPECT_NEAR(sum * (power + 1.0) * (power + 2.0), 1.0, 1e-15 * (power + 1) * (power + 2))
          << n << " points, power " << power;
    }
  }
}

TEST(GaussRules, OnePowerMoreIsNotExact) {
  for (const auto rule_of : {gauss_legendre, gauss_jacobi}) {
    const GaussRule& rule = rule_of(2);
    double sum = 0.0;
    for (int i = 0; i < 2; ++i) sum += rule.w[i] * std::pow(rule.x[i], 4);
    EXPECT_GT(std::abs(sum - (rule_of == gauss_legendre ? 1.0 / 5.0 : 1.0 / 30.0)), 1e-3);
  }
}

TEST(GaussRules, NodesAreInsideAndWeightsPositive) {
  for (int n = 1; n <= GaussRule::max_points; ++n)
    for (const GaussRule* rule : {&gauss_legendre(n), &gauss_jacobi(n)})
      for (int i = 0; i < n; ++i) {
        EXPECT_GT(rule->x[i], i == 0 ? 0.0 : rule->x[i - 1]);
        EXPECT_LT(rule->x[i], 1.0);
        EXPECT_GT(rule->w[i], 0.0);
      }
}

}  // namespace
}  // namespace twopass
