// Gauss's integration rules on [0, 1]: nodes and weights, computed once when first asked for.
#pragma once

#include <array>

namespace twopass {

/// Nodes `x` in (0, 1) and positive weights `w`; the first `n` of each are in use.
struct GaussRule {
  static constexpr int max_points = 16;

  int n = 0;
  std::array<double, max_points> x{};
  std::array<double, max_points> w{};
};

/// Int_0^1 f(x) dx, exact for polynomials of degree 2 n - 1. REQUIRES: 1 <= n <= GaussRule::max_points.
const GaussRule& gauss_legendre(int n);

/// Int_0^1 f(x) (1 - x) dx, exact for polynomials of degree 2 n - 1: the rule for the direction in which a
/// triangle narrows to its tip. REQUIRES: 1 <= n <= GaussRule::max_points.
const GaussRule& gauss_jacobi(int n);

}  // namespace twopass
