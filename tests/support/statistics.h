// Statistics for tests: means with their standard errors, z-tests and chi-square tests at a stated level.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace twopass::test {

/// Running mean and standard error (Welford).
class Estimate {
 public:
  void add(double x) {
    ++n_;
    const double d = x - mean_;
    mean_ += d / static_cast<double>(n_);
    m2_ += d * (x - mean_);
  }
  [[nodiscard]] double mean() const { return mean_; }
  [[nodiscard]] double variance() const { return n_ > 1 ? m2_ / static_cast<double>(n_ - 1) : 0.0; }
  [[nodiscard]] double standard_error() const { return std::sqrt(variance() / static_cast<double>(n_)); }
  [[nodiscard]] std::size_t count() const { return n_; }

 private:
  std::size_t n_ = 0;
  double mean_ = 0.0, m2_ = 0.0;
};

/// Probability that a standard normal variable exceeds |z| in absolute value.
inline double two_sided_p(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

/// Sidak's level for each of `tests` independent tests, so that all together err with probability `level`.
inline double sidak(double level, std::size_t tests) {
  return -std::expm1(std::log1p(-level) / static_cast<double>(tests));
}

/// Probability of a chi-square at least this large by chance (Wilson and Hilferty's normal approximation, good
/// to a few per cent of itself from 10 degrees of freedom on).
inline double chi2_p(double chi2, double degrees) {
  const double c = 2.0 / (9.0 * degrees);
  const double z = (std::cbrt(chi2 / degrees) - (1.0 - c)) / std::sqrt(c);
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

/// Chi-square test of counts against expected counts; cells expecting fewer than 5 are pooled. Returns the
/// p-value.
inline double chi2_test(const std::vector<double>& observed, const std::vector<double>& expected) {
  double chi2 = 0.0, pooled_observed = 0.0, pooled_expected = 0.0;
  int cells = 0;
  const auto add = [&](double o, double e) {
    chi2 += (o - e) * (o - e) / e;
    ++cells;
  };
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] >= 5.0) {
      add(observed[i], expected[i]);
    } else {
      pooled_observed += observed[i];
      pooled_expected += expected[i];
    }
  }
  if (pooled_expected > 0.0)
    add(pooled_observed, pooled_expected);
  else if (pooled_observed > 0.0)
    return 0.0;  // something was drawn where nothing may be
  return chi2_p(chi2, cells - 1);
}

}  // namespace twopass::test
