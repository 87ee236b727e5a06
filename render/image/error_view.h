// Errors to look at: maps, colours for them, the worst tiles, a histogram.
#pragma once

#include <array>
#include <cstdint>

#include "render/image/compare.h"

namespace twopass {

/// By pixel, row by row; 0 where a value is not finite. REQUIRES: of one size.
struct ErrorMaps {
  std::vector<float> difference;  ///< mean over the channels of t - r
  std::vector<float> magnitude;   ///< mean over the channels of |t - r|
  std::vector<float> relative;    ///< root of the pixel's relmse
};
ErrorMaps error_maps(const LayerPair& pair);

/// The value that a share of the finite values does not exceed in magnitude; 0 without any. REQUIRES: share in
/// [0, 1].
float quantile_of_magnitude(std::vector<float> values, double share);

/// 256 colours, 8 bits a channel of sRGB.
using ColorMap = std::array<std::array<std::uint8_t, 3>, 256>;
/// From black over violet and orange to light yellow; lighter is more.
const ColorMap& sequential_colors();
/// From blue over white to red; white is zero.
const ColorMap& diverging_colors();

/// A picture of a map: `low` has the first colour, `high` the last. Channels R, G, B, display-referred in [0,
/// 1].
Image colored(std::span<const float> values, int width, int height, float low, float high,
              const ColorMap& colors);

struct ErrorTile {
  int x = 0, y = 0, width = 0, height = 0;
  double relmse = 0.0;
  double bias = 0.0;   ///< mean of (t - r) / sqrt(r^2 + 0.01)
  double share = 0.0;  ///< of the sum of all pixels' relmse
};
/// The tiles of the given size with the largest relmse, largest first; those at the right and lower border may
/// be smaller.
std::vector<ErrorTile> worst_tiles(const LayerPair& pair, int tile_size, std::size_t count);

/// How many pixels have which relative error (ErrorMaps::relative), in decades.
struct ErrorHistogram {
  static constexpr int lowest_decade = -5, decades = 7, bins_per_decade = 4;
  std::array<std::size_t, decades * bins_per_decade> bins{};
  std::size_t below = 0, above = 0;
};
ErrorHistogram error_histogram(std::span<const float> relative);

}  // namespace twopass
