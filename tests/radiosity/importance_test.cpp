#include "radiosity/importance.h"

#include <gtest/gtest.h>

#include "radiosity/solvers.h"
#include "tests/radiosity/random_balance.h"

namespace twopass {
namespace {

// What the picture is, relative to what it was: each element that it sees over its own radiosity then.
double picture(const std::vector<C3d>& radiosity, const std::vector<C3d>& before,
               const std::vector<double>& parts) {
  double sum = 0.0;
  for (std::size_t i = 0; i < parts.size(); ++i) sum += parts[i] * radiosity[i].x / before[i].x;
  return sum;
}

// (R46) against the difference between two solutions: an element that sends out a little more, other than by
// reflection, changes the picture by so much where that is seen by way of others.
TEST(Importance, IsTheChangeOfThePictureWithAnElementsLight) {
  constexpr std::uint32_t n = 40;
  Balance balance = test::random_balance(n, 0.6, false, 11);
  for (std::uint32_t i = 0; i < n; ++i) {
    balance.reflectance[i] = C3f(0.3f + 0.01f * static_cast<float>(i));
    balance.direct[i] = C3d(1.0 + i % 5);
  }
  std::vector<double> parts(n, 0.0);
  for (std::uint32_t i = 0; i < n; i += 3) parts[i] = 3.0 / n;
  const std::vector<C3d> before = solve_lu(balance).radiosity;
  const std::vector<double> importance = indirect_importance(balance, before, parts);
  for (std::uint32_t j = 0; j < n; ++j) {
    // Light of element j alone as a source of direct light of all others.
    constexpr double more = 1e-3;
    std::vector<C3d> source(n, C3d(0.0));
    source[j] = C3d(more);
    Balance changed = balance;
    const std::vector<C3d> arrives = balance.gather_all(source);
    for (std::uint32_t i = 0; i < n; ++i) changed.direct[i] += arrives[i];
    const double change =
        (picture(solve_lu(changed).radiosity, before, parts) - picture(before, before, parts)) / more;
    // What eight reflections leave out: (.7 x .6)^8.
    EXPECT_NEAR(importance[j], change, 2e-3 * change);
    EXPECT_LE(importance[j], change * (1.0 + 1e-6));
  }
}

TEST(Importance, OfAPictureThatSeesNothingIsNothing) {
  const Balance balance = test::random_balance(10, 0.6, false, 3);
  const std::vector<C3d> dark(10, C3d(0.0));
  const std::vector<double> parts(10, 0.1);
  for (const double importance : indirect_importance(balance, dark, parts)) EXPECT_EQ(importance, 0.0);
}

}  // namespace
}  // namespace twopass
