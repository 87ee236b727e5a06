// Making estimated form factors satisfy what is known of their sums.
#pragma once

#include <span>

#include "radiosity/balance.h"

namespace twopass {

/// What is known of the sums of the elements' exchange, in units of area, by element.
struct RowSums {
  bool known = false;          ///< the sums are to be `target`; otherwise only `limit` holds
  bool closed = false;         ///< `target` is all there is: a limit would only take from it
  std::vector<double> fixed;   ///< exchanged with what is no element
  std::vector<double> target;  ///< of exchange with elements and `fixed`
  std::vector<double> limit;   ///< of exchange with elements
};

/// Scales rows and columns of the exchange by the same factors d until Sum_j d_i X_ij d_j + d_i fixed_i =
/// target_i to `tolerance` (R14), as far as this is possible with factors between 1/4 and 4. The matrix stays
/// symmetric and the scaling changes each entry as little as its statistics allow. Rows without entries are
/// left alone. Returns the largest |sum - target| / area that is left. `fixed` is what a row exchanges with
/// what is no element.
double scale_to_row_sums(ExchangeMatrix& exchange, std::span<const double> fixed,
                         std::span<const double> target, std::span<const double> area, double tolerance);

/// Scales down rows, and their columns with them, until no row's sum is above its limit.
void cap_row_sums(ExchangeMatrix& exchange, std::span<const double> limit);

/// The sums of the rows.
std::vector<double> row_sums(const ExchangeMatrix& exchange);

}  // namespace twopass
