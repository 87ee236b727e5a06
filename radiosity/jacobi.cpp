#include "radiosity/solvers.h"

namespace twopass {

SolverResult solve_jacobi(const Balance& balance, const StopRule& stop) {
  const Contraction q = contraction(balance);
  SolverResult result;
  const std::uint32_t n = balance.count();
  result.irradiance.assign(n, C3d(0.0));
  result.radiosity.resize(n);
  while (true) {
    for (std::uint32_t i = 0; i < n; ++i)
      result.radiosity[i] = C3d(balance.reflectance[i]) * (balance.direct[i] + result.irradiance[i]);
    // What the next sweep needs tells the error of this one.
    result.irradiance = balance.gather_all(result.radiosity);
    result.error = balance_error(balance, q, result.radiosity, result.irradiance);
    if (result.error.bound <= stop.relative_error || result.iterations >= stop.max_iterations) return result;
    ++result.iterations;
  }
}

}  // namespace twopass
