#include "radiosity/error_bound.h"

namespace twopass {

Contraction contraction(const Balance& balance) {
  Contraction q;
  q.by_irradiance = C3d(0.0);
  const std::uint32_t n = balance.count();
  std::vector<C3d> column(n, C3d(0.0));  // Sum_i A_i rho_i F_ij
  for (std::uint32_t i = 0; i < n; ++i) {
    const double area = balance.area[i];
    if (!(area > 0.0)) continue;
    const C3d rho(balance.reflectance[i]);
    C3d row(0.0), white(0.0);
    for (ExchangeMatrix::InnerIterator it(balance.exchange, i); it; ++it) {
      row += C3d(static_cast<double>(it.value()) / area);
      white += C3d(balance.reflectance[static_cast<std::size_t>(it.col())]) *
               (static_cast<double>(it.value()) / area);
      column[static_cast<std::size_t>(it.col())] += rho * static_cast<double>(it.value());
    }
    for (const SpecularLink& link : balance.specular.of(i)) {
      row += C3d(link.weight);
      white += C3d(balance.reflectance[link.element]) * C3d(link.weight);
      column[link.element] += rho * C3d(link.weight) * area;
    }
    for (int c = 0; c < 3; ++c) {
      q.by_maximum[c] = std::max(q.by_maximum[c], rho[c] * row[c]);
      q.by_irradiance[c] = std::max(q.by_irradiance[c], white[c]);
    }
  }
  for (std::uint32_t j = 0; j < n; ++j)
    for (int c = 0; c < 3 && balance.area[j] > 0.0; ++c)
      q.by_power[c] = std::max(q.by_power[c], column[j][c] / balance.area[j]);
  return q;
}

double error_from_residual(double q_power, double q_maximum, double residual_power, double residual_maximum,
                           double total_area) {
  double error = std::numeric_limits<double>::infinity();
  if (q_power < 1.0) error = std::min(error, residual_power / (1.0 - q_power));
  if (q_maximum < 1.0) error = std::min(error, total_area * residual_maximum / (1.0 - q_maximum));
  return error;
}

BalanceError balance_error(const Balance& balance, const Contraction& q, std::span<const C3d> radiosity,
                           std::span<const C3d> gathered) {
  return error_of_residual(balance, q, radiosity, residual_of(balance, radiosity, gathered));
}

std::vector<C3d> residual_of(const Balance& balance, std::span<const C3d> radiosity,
                             std::span<const C3d> gathered) {
  std::vector<C3d> residual(balance.count());
  for (std::uint32_t i = 0; i < balance.count(); ++i)
    residual[i] = C3d(balance.reflectance[i]) * (balance.direct[i] + gathered[i]) - radiosity[i];
  return residual;
}

BalanceError error_of_residual(const Balance& balance, const Contraction& q, std::span<const C3d> radiosity,
                               std::span<const C3d> residual) {
  C3d power(0.0), residual_power(0.0), residual_maximum(0.0), residual_irradiance(0.0), white_power(0.0);
  double total_area = 0.0;
  for (std::uint32_t i = 0; i < balance.count(); ++i) {
    total_area += balance.area[i];
    power += radiosity[i] * balance.area[i];
    for (int c = 0; c < 3; ++c) {
      residual_power[c] += balance.area[i] * std::abs(residual[i][c]);
      residual_maximum[c] = std::max(residual_maximum[c], std::abs(residual[i][c]));
      const double rho = balance.reflectance[i][c];
      white_power[c] += balance.area[i] * rho;
      if (residual[i][c] != 0.0)
        residual_irradiance[c] = std::max(residual_irradiance[c], std::abs(residual[i][c]) / rho);
    }
  }
  BalanceError error;
  for (int c = 0; c < 3; ++c) {
    if (residual_power[c] == 0.0) continue;  // a dark channel has no error
    // Iterates that may be negative can add up to nothing: then there is nothing to be relative to.
    if (!(power[c] > 0.0))
      return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    double absolute =
        error_from_residual(q.by_power[c], q.by_maximum[c], residual_power[c], residual_maximum[c], total_area);
    if (q.by_irradiance[c] < 1.0)
      absolute = std::min(absolute, white_power[c] * residual_irradiance[c] / (1.0 - q.by_irradiance[c]));
    error.residual = std::max(error.residual, residual_power[c] / power[c]);
    error.bound = std::max(error.bound, absolute / power[c]);
  }
  return error;
}

}  // namespace twopass
