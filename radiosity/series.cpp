#include "radiosity/solvers.h"

namespace twopass {

SolverResult solve_series(const Balance& balance, int reflections) {
  SolverResult result;
  const std::uint32_t n = balance.count();
  result.radiosity.resize(n);
  result.irradiance.assign(n, C3d(0.0));
  for (int k = 0;; ++k) {
    for (std::uint32_t i = 0; i < n; ++i)
      result.radiosity[i] = C3d(balance.reflectance[i]) * (balance.direct[i] + result.irradiance[i]);
    if (k == reflections) return result;
    result.irradiance = balance.gather_all(result.radiosity);
    ++result.iterations;
  }
}

}  // namespace twopass
