#include <Eigen/LU>

#include "radiosity/solvers.h"
#include "render/core/error.h"

namespace twopass {

namespace {

// I - rho F for one channel.
Eigen::MatrixXd dense_matrix(const Balance& balance, int channel) {
  const std::uint32_t n = balance.count();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(n, n);
  for (std::uint32_t i = 0; i < n; ++i) {
    if (!(balance.area[i] > 0.0)) continue;
    const double rho = balance.reflectance[i][channel];
    for (ExchangeMatrix::InnerIterator it(balance.exchange, i); it; ++it)
      matrix(i, it.col()) -= rho * static_cast<double>(it.value()) / balance.area[i];
    for (const SpecularLink& link : balance.specular.of(i))
      matrix(i, link.element) -= rho * static_cast<double>(link.weight[channel]);
  }
  return matrix;
}

// Whether two channels have one matrix: grey scenes are common, and elimination is dear.
bool have_same_matrix(const Balance& balance, int a, int b) {
  for (const C3f& rho : balance.reflectance)
    if (rho[a] != rho[b]) return false;
  for (const SpecularLink& link : balance.specular.link)
    if (link.weight[a] != link.weight[b]) return false;
  return true;
}

}  // namespace

SolverResult solve_lu(const Balance& balance) {
  const std::uint32_t n = balance.count();
  if (n > lu_max_elements)
    throw Error("solver lu",
                std::to_string(n) + " elements are more than the " + std::to_string(lu_max_elements) +
                    " that Gaussian elimination handles",
                "use --solver gauss-seidel, or fewer elements (--elements)");
  SolverResult result;
  result.iterations = 1;
  result.radiosity.resize(n);
  Eigen::PartialPivLU<Eigen::MatrixXd> factors;
  for (int c = 0; c < 3; ++c) {
    if (c == 0 || !have_same_matrix(balance, c - 1, c)) factors.compute(dense_matrix(balance, c));
    Eigen::VectorXd right(n);
    for (std::uint32_t i = 0; i < n; ++i)
      right[i] = static_cast<double>(balance.reflectance[i][c]) * balance.direct[i][c];
    const Eigen::VectorXd solution = factors.solve(right);
    for (std::uint32_t i = 0; i < n; ++i) result.radiosity[i][c] = solution[i];
  }
  result.irradiance = balance.gather_all(result.radiosity);
  result.error = balance_error(balance, contraction(balance), result.radiosity, result.irradiance);
  return result;
}

}  // namespace twopass
