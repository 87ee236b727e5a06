// Making a dense, symmetric table of exchanges satisfy what is known of its sums.
#pragma once

#include <span>
#include <vector>

namespace twopass {

using ExchangeTable = std::vector<std::vector<double>>;

/// Scales rows and columns by common factors until every row adds up to its area (R27), as for a closed scene.
/// Symmetric entries stay equal to the last bit. Rows without entries stay as they are; where no factors can
/// satisfy all rows, the error that is left is visible in the sums.
void scale_rows_to_areas(ExchangeTable& exchange, std::span<const double> area);

/// Scales down rows, and their columns with them, whose sum is above their area.
void cap_rows_at_areas(ExchangeTable& exchange, std::span<const double> area);

}  // namespace twopass
