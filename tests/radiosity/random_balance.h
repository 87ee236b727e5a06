// Random systems of equations with the structure of a radiosity balance, and the textbook one of a cube.
#pragma once

#include <random>

#include "radiosity/balance.h"

namespace twopass::test {

/// `n` elements of random areas and colours; form factors of each add up to at most `row_sum`. With `specular`,
/// some of the exchange goes over links instead.
inline Balance random_balance(int n, double row_sum, bool specular, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Balance balance;
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    balance.area.push_back(0.1 + uniform(random));
    balance.reflectance.push_back(C3f(float(uniform(random)), float(0.95 * uniform(random)), 0.0f));
    balance.direct.push_back(uniform(random) < 0.3 ? C3d(uniform(random), 10.0 * uniform(random), 1.0)
                                                   : C3d(0.0));
    for (int j = 0; j < i; ++j)
      if (uniform(random) < 0.5) x(i, j) = x(j, i) = uniform(random);
  }
  double largest = 0.0;
  for (int i = 0; i < n; ++i) largest = std::max(largest, x.row(i).sum() / balance.area[size_t(i)]);
  if (largest > 0.0) x *= row_sum * (specular ? 0.5 : 1.0) / largest;
  balance.exchange = x.cast<float>().sparseView();
  balance.exchange.makeCompressed();
  if (!specular) return balance;
  for (int i = 0; i < n; ++i) {
    balance.specular.first.push_back(balance.specular.link.size());
    const auto j = static_cast<std::uint32_t>(uniform(random) * n);
    balance.specular.link.push_back({j, C3f(float(0.4 * row_sum * uniform(random)), 0.1f, 0.2f)});
  }
  balance.specular.first.push_back(balance.specular.link.size());
  return balance;
}

/// Sum over channels and elements of area x |difference|, by channel.
inline C3d power_difference(const Balance& balance, const std::vector<C3d>& a, const std::vector<C3d>& b) {
  C3d sum(0.0);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int c = 0; c < 3; ++c) sum[c] += balance.area[i] * std::abs(a[i][c] - b[i][c]);
  return sum;
}

}  // namespace twopass::test
