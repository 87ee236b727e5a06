// The statistics that other tests stand on.
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

namespace twopass::test {
namespace {

TEST(Statistics, EstimateHasTheTextbookMoments) {
  Estimate e;
  for (const double x : {2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0}) e.add(x);
  EXPECT_DOUBLE_EQ(e.mean(), 5.0);
  EXPECT_DOUBLE_EQ(e.variance(), 32.0 / 7.0);
}

TEST(Statistics, PValuesMatchTables) {
  EXPECT_NEAR(two_sided_p(1.959964), 0.05, 1e-6);
  EXPECT_NEAR(chi2_p(18.307, 10), 0.05, 1e-3);
  EXPECT_NEAR(chi2_p(124.342, 100), 0.05, 1e-3);
  EXPECT_NEAR(sidak(0.01, 100), 1.00498e-4, 1e-8);
}

TEST(Statistics, AWrongDistributionFails) {
  EXPECT_GT(chi2_test({100, 105, 95, 100}, {100, 100, 100, 100}), 0.01);
  EXPECT_LT(chi2_test({150, 105, 45, 100}, {100, 100, 100, 100}), 1e-6);
  EXPECT_EQ(chi2_test({100, 3}, {103, 0}), 0.0);
}

}  // namespace
}  // namespace twopass::test
