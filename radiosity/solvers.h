// Ways to solve the balance (R11). All of them have the same solution; the iterations stop by the same
// guaranteed bound, or when the user wants to stop.
#pragma once

#include "radiosity/error_bound.h"

namespace twopass {

struct StopRule {
  double relative_error = 0.01;  ///< iterate until BalanceError::bound is at most this
  std::size_t max_iterations = std::numeric_limits<std::size_t>::max();
};

struct SolverResult {
  std::vector<C3d> radiosity;   ///< reflected radiosity by element, W/m2
  std::vector<C3d> irradiance;  ///< F B: the indirect irradiance by element, W/m2
  std::size_t iterations = 0;   ///< sweeps over all rows, products with the matrix (cg), or shots
  BalanceError error;           ///< of `radiosity`
  /// What the unshot power would add everywhere if it were spread evenly, W/m2 of irradiance: makes an early
  /// stopped progressive solution fit to look at (R19), and is not part of it. Zero for the other solvers.
  C3d ambient{0.0};
};

/// Gathers to all elements from the last sweep's values (R21): the Neumann series (R20) until the bound is met.
/// The residual shrinks by about rho a sweep.
SolverResult solve_jacobi(const Balance& balance, const StopRule& stop);

/// Gathers to one element after the other from the newest values (R17). The residual shrinks by about rho^2 a
/// sweep.
SolverResult solve_gauss_seidel(const Balance& balance, const StopRule& stop);

/// Shoots from the element of the most unshot power, relaxing a column at a time (R18). Much of the light is in
/// place long before every element has shot once. Every iterate is a lower bound of the solution, unless it
/// may `overshoot`: then an element also shoots its share of what the others' unshot power will bring it (R23),
/// and unshot power can be negative. Saves shots where albedos are high; the bound holds all the same.
SolverResult solve_progressive(const Balance& balance, const StopRule& stop, bool overshoot = false);

/// Conjugate gradients on the symmetric form of the balance (R22), three channels at once. The error shrinks at
/// least by about (1 - sqrt(1 - rho^2)) / rho a product with the matrix. Specular links, which are not
/// symmetric, are lagged: an outer iteration around the inner one.
SolverResult solve_cg(const Balance& balance, const StopRule& stop);

inline constexpr std::uint32_t lu_max_elements = 3000;

/// Gaussian elimination with partial pivoting, n^3 work. Throws Error for more than `lu_max_elements`.
SolverResult solve_lu(const Balance& balance);

/// The light of at most `reflections` diffuse reflections after the direct irradiance: that many terms of the
/// Neumann series (R20), whatever they leave out. No iteration, so there is no error of stopping early.
SolverResult solve_series(const Balance& balance, int reflections);

}  // namespace twopass
