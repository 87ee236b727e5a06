// Random systems of equations with the structure of a radiosity balance, and the textbook one of a cube.
#pragma once

#include <random>

#include "radiosity/enforce.h"

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

/// `n` elements of random areas and one albedo (half of it in the last channel) that see only each other: form
/// factors of each add up to 1, less half of it with `specular`, which has links instead: weights of 1/2 in
/// all. Some have direct irradiance.
inline Balance closed_balance(int n, float albedo, bool specular, unsigned seed) {
  Balance balance = random_balance(n, 1.0, false, seed);
  std::mt19937 random(seed + 1);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Eigen::MatrixXd x(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j)
      x(i, j) = x(j, i) = (0.1 + uniform(random)) * balance.area[size_t(i)] * balance.area[size_t(j)] / n;
  balance.exchange = x.cast<float>().sparseView();
  std::vector<double> target = balance.area;
  for (double& area : target) area *= specular ? 0.5 : 1.0;
  scale_to_row_sums(balance.exchange, std::vector<double>(size_t(n), 0.0), target, balance.area, 1e-9);
  balance.reflectance.assign(size_t(n), C3f(albedo, albedo, 0.5f * albedo));
  balance.direct[0] = C3d(1.0, 2.0, 0.1);
  for (int i = 0; specular && i < n; ++i) {
    balance.specular.first.push_back(balance.specular.link.size());
    for (int k = 0; k < 2; ++k)
      balance.specular.link.push_back(
          {static_cast<std::uint32_t>(uniform(random) * n), C3f(0.25f, 0.2f, 0.25f)});
  }
  if (specular) balance.specular.first.push_back(balance.specular.link.size());
  return balance;
}

/// Buries an element, as a scene does: it has no area and neither gives nor receives anything.
inline void bury(Balance& balance, std::uint32_t element) {
  balance.area[element] = 0.0;
  balance.direct[element] = C3d(0.0);
  balance.exchange.prune([=](Eigen::Index i, Eigen::Index j, float) { return i != element && j != element; });
  for (std::uint32_t i = 0; i < balance.count() && !balance.specular.first.empty(); ++i)
    for (std::size_t k = balance.specular.first[i]; k < balance.specular.first[i + 1]; ++k)
      if (i == element || balance.specular.link[k].element == element)
        balance.specular.link[k].weight = C3f(0.0f);
}

/// Sum over channels and elements of area x |difference|, by channel.
inline C3d power_difference(const Balance& balance, const std::vector<C3d>& a, const std::vector<C3d>& b) {
  C3d sum(0.0);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int c = 0; c < 3; ++c) sum[c] += balance.area[i] * std::abs(a[i][c] - b[i][c]);
  return sum;
}

}  // namespace twopass::test
