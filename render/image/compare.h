// How far a picture is from a reference: the measures of `twopass compare`, with their formulas.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/core/types.h"
#include "render/image/layers.h"

namespace twopass {

/// relMSE divides by r^2 plus this, so that black pixels do not own the measure; radiance squared.
inline constexpr double relmse_epsilon = 0.01;
/// Edge of the blocks of pixels that tell bias from noise.
inline constexpr int bias_block = 8;

/// One layer of two pictures of one size, row by row.
struct LayerPair {
  std::string name;  ///< as of Layer
  LayerKind kind = LayerKind::color;
  int width = 0;
  int height = 0;
  std::vector<C3f> test{};
  std::vector<C3f> reference{};
  /// Of the difference of the pixels' means, as far as the files tell; empty: they do not.
  std::vector<C3f> variance{};
};

/// The layers that both pictures have, the picture itself first. A colour layer called `variance` (in any
/// letter case) is the variance of the picture's own mean and becomes part of its pair. Throws Error when the
/// sizes differ or there is no layer in common.
std::vector<LayerPair> common_layers(const Image& test, const Image& reference);

/// Pixels that are not finite in either picture are counted and left out of every measure (FLIP sees them
/// black). Nothing here is ever NaN; a measure without a value (no pixel left; a zero reference) is infinite.
struct Comparison {
  C3d energy_ratio{1.0, 1.0, 1.0};
  /// Half width of its 95 % interval as far as noise goes that neighbours do not share.
  C3d energy_ci95{0.0, 0.0, 0.0};
  /// What relmse consists of by blocks of 8x8 pixels: the square of what neighbours have in common, and the
  /// rest. Unbiased, hence below zero at times where there is no bias.
  double bias2 = 0.0;
  double variance = 0.0;
  double bias2_error = 0.0;  ///< standard error of bias2, by the scatter of the blocks
  /// The same by the files' own variance; none where they have no such layer.
  std::optional<double> known_variance{};
  double mse = 0.0;
  double relmse = 0.0;
  double relmse_trimmed = 0.0;
  double smape = 0.0;
  double psnr = 0.0;  ///< decibels; infinite for equal pictures
  double flip = 0.0;
  std::size_t non_finite = 0;
  int width = 0;
  int height = 0;
  std::vector<float> flip_map{};  ///< by pixel, in [0, 1]; empty where no pixel is left or it is no colour
};

/// Compares a layer. Of others than colours psnr and flip are infinite: nobody sees them.
Comparison compare(const LayerPair& pair);
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
