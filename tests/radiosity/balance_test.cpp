#include "radiosity/balance.h"

#include <gtest/gtest.h>

#include "tests/radiosity/random_balance.h"

namespace twopass {
namespace {

TEST(Balance, GathersOverDirectAndSpecularLinks) {
  Balance balance;
  balance.area = {2.0, 0.5};
  balance.exchange.resize(2, 2);
  balance.exchange.insert(0, 1) = 0.25f;
  balance.exchange.insert(1, 0) = 0.25f;
  const std::vector<C3d> radiosity{C3d(1, 2, 3), C3d(8, 16, 32)};
  EXPECT_EQ(balance.gather(0, radiosity), C3d(1, 2, 4));
  EXPECT_EQ(balance.gather(1, radiosity), C3d(0.5, 1, 1.5));
  balance.specular.first = {0, 1, 1};
  balance.specular.link = {{0, C3f(0.5f, 0.25f, 0.0f)}};
  EXPECT_EQ(balance.gather(0, radiosity), C3d(1.5, 2.5, 4));
  EXPECT_EQ(balance.gather(1, radiosity), C3d(0.5, 1, 1.5));
  EXPECT_EQ(balance.gather_all(radiosity)[0], balance.gather(0, radiosity));
}

TEST(Balance, SymmetricExchangeConservesPower) {
  const Balance balance = test::random_balance(50, 1.0, false, 7);
  std::vector<C3d> radiosity;
  for (int i = 0; i < 50; ++i) radiosity.emplace_back(i % 7, i % 5, i % 3);
  // What arrives is what leaves towards others: Sum A_i (F B)_i = Sum B_j Sum_i X_ij.
  C3d arrives(0.0), leaves(0.0);
  const std::vector<C3d> gathered = balance.gather_all(radiosity);
  for (std::uint32_t i = 0; i < 50; ++i) {
    arrives += gathered[i] * balance.area[i];
    for (ExchangeMatrix::InnerIterator it(balance.exchange, i); it; ++it)
      leaves += radiosity[i] * static_cast<double>(it.value());
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(arrives[c], leaves[c], 1e-12 * leaves[c]);
}

}  // namespace
}  // namespace twopass
