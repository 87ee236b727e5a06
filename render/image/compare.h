// How far a picture is from a reference: the measures of `twopass compare`, with their formulas.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "render/core/types.h"
#include "render/image/image.h"

namespace twopass {

/// relMSE divides by r^2 plus this, so that black pixels do not own the measure; radiance squared.
inline constexpr double relmse_epsilon = 0.01;

/// Pixels that are not finite in either picture are counted and left out of every measure (FLIP sees them
/// black). Nothing here is ever NaN; a measure without a value (no pixel left; a zero reference) is infinite.
struct Comparison {
  C3d energy_ratio{1.0, 1.0, 1.0};
  double mse = 0.0;
  double relmse = 0.0;
  double relmse_trimmed = 0.0;
  double smape = 0.0;
  double psnr = 0.0;  ///< decibels; infinite for equal pictures
  double flip = 0.0;
  std::size_t non_finite = 0;
  int width = 0;
  int height = 0;
};

/// Compares the unnamed layers of two linear pictures. Throws Error when the sizes differ or a picture has no
/// colour.
Comparison compare(const Image& test, const Image& reference);

struct Measure {
  std::string_view name;
  std::string_view formula;            ///< in words and symbols: t the test, r the reference, d = t - r
  double (*value)(const Comparison&);  ///< one number, for thresholds: of energy_ratio the largest channel
};

/// Every measure once, in the order of Comparison.
std::span<const Measure> measures();
/// The measure called `name`. Throws Error at `where`, listing the names.
const Measure& measure_of_name(std::string_view name, std::string_view where);

}  // namespace twopass
