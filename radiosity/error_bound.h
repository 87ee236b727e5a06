// How far an approximate radiosity can be from the solution of its equations, without knowing the solution.
#pragma once

#include "radiosity/balance.h"

namespace twopass {

/// By how much one reflection shrinks any difference of radiosities, per channel, in three norms. The first two
/// are below one when the form factors of an element add up to at most one; the third where glossy lobes add to
/// them, too, as long as no surface reflects more than it receives.
struct Contraction {
  C3d by_maximum{0.0};  ///< of the largest value: the largest rho_i Sum_j F_ij
  C3d by_power{0.0};    ///< of the sum of area x value: the largest Sum_i A_i rho_i F_ij / A_j
  C3d by_irradiance{std::numeric_limits<double>::infinity()};  ///< of value / rho: the largest Sum_j F_ij rho_j
};

Contraction contraction(const Balance& balance);

struct BalanceError {
  double residual = 0.0;  ///< Sum A |rho (H + F B) - B| / Sum A B of the worst channel
  double bound = 0.0;     ///< at least Sum A |error| / Sum A B of the worst channel (R16)
};

/// `gathered` is F B (Balance::gather_all). Holds for any radiosity; infinite if Sum A B of a channel is not
/// positive while its residual is not zero.
BalanceError balance_error(const Balance& balance, const Contraction& q, std::span<const C3d> radiosity,
                           std::span<const C3d> gathered);

/// The residual rho (H + F B) - B of each element; `gathered` is F B.
std::vector<C3d> residual_of(const Balance& balance, std::span<const C3d> radiosity,
                             std::span<const C3d> gathered);

/// As `balance_error`, of a residual that is known already.
BalanceError error_of_residual(const Balance& balance, const Contraction& q, std::span<const C3d> radiosity,
                               std::span<const C3d> residual);

/// The larger of a norm's two bounds' best: Sum A |error| when Sum A |residual| and max |residual| are given,
/// for one channel of the contraction; infinite when nothing is guaranteed.
double error_from_residual(double q_power, double q_maximum, double residual_power, double residual_maximum,
                           double total_area);

}  // namespace twopass
