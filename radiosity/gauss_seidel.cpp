#include "radiosity/solvers.h"

namespace twopass {

SolverResult solve_gauss_seidel(const Balance& balance, const StopRule& stop) {
  const Contraction q = contraction(balance);
  SolverResult result;
  const std::uint32_t n = balance.count();
  result.radiosity.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) result.radiosity[i] = C3d(balance.reflectance[i]) * balance.direct[i];
  while (true) {
    result.irradiance = balance.gather_all(result.radiosity);
    result.error = balance_error(balance, q, result.radiosity, result.irradiance);
    if (result.error.bound <= stop.relative_error || result.iterations >= stop.max_iterations) return result;
    for (std::uint32_t i = 0; i < n; ++i)
      result.radiosity[i] =
          C3d(balance.reflectance[i]) * (balance.direct[i] + balance.gather(i, result.radiosity));
    ++result.iterations;
  }
}

}  // namespace twopass
