#include "radiosity/enforce.h"

#include "render/core/interrupt.h"
#include "render/core/parallel.h"

namespace twopass {

namespace {

double scaled_row_sum(const ExchangeMatrix& exchange, std::size_t row, std::span<const double> d) {
  double sum = 0.0;
  for (ExchangeMatrix::InnerIterator it(exchange, static_cast<Eigen::Index>(row)); it; ++it)
    sum += static_cast<double>(it.value()) * d[static_cast<std::size_t>(it.col())];
  return d[row] * sum;
}

void apply_scaling(ExchangeMatrix& exchange, std::span<const double> d) {
  parallel_for(d.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (ExchangeMatrix::InnerIterator it(exchange, static_cast<Eigen::Index>(i)); it; ++it)
        // The product of the factors first: it commutes, so X_ij and X_ji stay equal to the last bit.
        it.valueRef() = static_cast<float>(static_cast<double>(it.value()) *
                                           (d[i] * d[static_cast<std::size_t>(it.col())]));
  });
}

}  // namespace

std::vector<double> row_sums(const ExchangeMatrix& exchange) {
  const std::vector<double> ones(static_cast<std::size_t>(exchange.rows()), 1.0);
  std::vector<double> sums(ones.size());
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = scaled_row_sum(exchange, i, ones);
  return sums;
}

double scale_to_row_sums(ExchangeMatrix& exchange, std::span<const double> fixed,
                         std::span<const double> target, std::span<const double> area, double tolerance) {
  constexpr int most_passes = 100;
  constexpr double largest_factor = 4.0;
  const std::size_t n = target.size();
  std::vector<double> d(n, 1.0), sum(n);
  for (std::size_t i = 0; i < n; ++i)
    if (!(target[i] > 0.0)) d[i] = 0.0;  // buried, or it sees nothing but what absorbs
  double worst = 0.0;
  for (int pass = 0;; ++pass) {
    throw_if_interrupted();
    parallel_for(n, 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) sum[i] = scaled_row_sum(exchange, i, d) + d[i] * fixed[i];
    });
    worst = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      if (sum[i] > 0.0 && area[i] > 0.0) worst = std::max(worst, std::abs(sum[i] - target[i]) / area[i]);
    if (worst <= tolerance || pass == most_passes) break;
    // The square root: rows and columns each do half of the work, as both are scaled at once.
    for (std::size_t i = 0; i < n; ++i)
      if (sum[i] > 0.0 && target[i] > 0.0)
        d[i] = std::clamp(d[i] * std::sqrt(target[i] / sum[i]), 1.0 / largest_factor, largest_factor);
  }
  apply_scaling(exchange, d);
  return worst;
}

void cap_row_sums(ExchangeMatrix& exchange, std::span<const double> limit) {
  std::vector<double> d(limit.size(), 1.0);
  bool changed = false;
  // Later rows only make the sums of earlier ones smaller, so once is enough.
  for (std::size_t i = 0; i < d.size(); ++i) {
    const double sum = scaled_row_sum(exchange, i, d);
    if (!(sum > limit[i])) continue;
    d[i] = limit[i] / sum;
    changed = true;
  }
  if (changed) apply_scaling(exchange, d);
}

}  // namespace twopass
