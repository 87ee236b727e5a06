#include "radiosity/table_closure.h"

#include <algorithm>
#include <cmath>

#include "render/core/interrupt.h"

namespace twopass {

namespace {

double scaled_row_sum(const ExchangeTable& exchange, std::size_t i, std::span<const double> d) {
  double sum = 0.0;
  for (std::size_t j = 0; j < d.size(); ++j) sum += exchange[i][j] * d[j];
  return d[i] * sum;
}

void scale(ExchangeTable& exchange, std::span<const double> d) {
  for (std::size_t i = 0; i < d.size(); ++i)
    for (std::size_t j = 0; j < d.size(); ++j)
      exchange[i][j] *= d[i] * d[j];  // this product commutes, so that the table stays symmetric
}

}  // namespace

void scale_rows_to_areas(ExchangeTable& exchange, std::span<const double> area) {
  constexpr double tolerance = 1e-13;
  constexpr double most_work = 2e9;
  const std::size_t n = area.size();
  const auto most_passes = static_cast<int>(
      std::clamp(most_work / (static_cast<double>(n) * static_cast<double>(n) + 1.0), 100.0, 1e4));
  std::vector<double> d(n, 1.0), sum(n);
  for (int pass = 0; pass < most_passes; ++pass) {
    throw_if_interrupted();
    double worst = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      sum[i] = scaled_row_sum(exchange, i, d);
      if (sum[i] > 0.0) worst = std::max(worst, std::abs(sum[i] / area[i] - 1.0));
    }
    if (worst <= tolerance) break;
    for (std::size_t i = 0; i < n; ++i)
      if (sum[i] > 0.0) d[i] *= std::sqrt(area[i] / sum[i]);
  }
  scale(exchange, d);
}

void cap_rows_at_areas(ExchangeTable& exchange, std::span<const double> area) {
  std::vector<double> d(area.size(), 1.0);
  // Later rows only make the sums of earlier ones smaller, so once is enough.
  for (std::size_t i = 0; i < d.size(); ++i) {
    const double sum = scaled_row_sum(exchange, i, d);
    if (sum > area[i]) d[i] *= area[i] / sum;
  }
  scale(exchange, d);
}

}  // namespace twopass
