#include "render/image/error_view.h"

#include <algorithm>
#include <cmath>

namespace twopass {

namespace {

struct Stop {
  double at;
  std::array<double, 3> color;
};

// Piecewise linear between the stops.
template <std::size_t N>
ColorMap map_through(const std::array<Stop, N>& stops) {
  ColorMap map;
  std::size_t next = 1;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double at = static_cast<double>(i) / 255.0;
    while (next + 1 < N && at > stops[next].at) ++next;
    const Stop &a = stops[next - 1], &b = stops[next];
    const double t = (at - a.at) / (b.at - a.at);
    for (std::size_t c = 0; c < 3; ++c)
      map[i][c] = static_cast<std::uint8_t>(std::lround(a.color[c] + t * (b.color[c] - a.color[c])));
  }
  return map;
}

}  // namespace

const ColorMap& sequential_colors() {
  static const ColorMap map = map_through<6>({{{0.0, {0, 0, 0}},
                                               {0.2, {50, 15, 95}},
                                               {0.4, {125, 30, 105}},
                                               {0.6, {200, 65, 70}},
                                               {0.8, {245, 145, 40}},
                                               {1.0, {255, 250, 190}}}});
  return map;
}

const ColorMap& diverging_colors() {
  static const ColorMap map = map_through<5>({{{0.0, {5, 35, 110}},
                                               {0.25, {70, 140, 210}},
                                               {0.5, {250, 250, 250}},
                                               {0.75, {225, 110, 75}},
                                               {1.0, {110, 5, 30}}}});
  return map;
}

ErrorMaps error_maps(const LayerPair& pair) {
  ErrorMaps maps;
  const std::size_t pixels = pair.test.size();
  for (std::vector<float>* map : {&maps.difference, &maps.magnitude, &maps.relative}) map->resize(pixels, 0.0f);
  for (std::size_t i = 0; i < pixels; ++i) {
    const C3f &t = pair.test[i], &r = pair.reference[i];
    if (!is_finite(t) || !is_finite(r)) continue;
    double sum = 0.0, magnitude = 0.0, relative = 0.0;
    for (int c = 0; c < 3; ++c) {
      const double d = static_cast<double>(t[c]) - r[c];
      sum += d;
      magnitude += std::abs(d);
      relative += d * d / (static_cast<double>(r[c]) * r[c] + relmse_epsilon);
    }
    maps.difference[i] = static_cast<float>(sum / 3.0);
    maps.magnitude[i] = static_cast<float>(magnitude / 3.0);
    maps.relative[i] = static_cast<float>(std::sqrt(relative / 3.0));
  }
  return maps;
}

float quantile_of_magnitude(std::vector<float> values, double share) {
  std::erase_if(values, [](float v) { return !std::isfinite(v); });
  if (values.empty()) return 0.0f;
  for (float& v : values) v = std::abs(v);
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

Image colored(std::span<const float> values, int width, int height, float low, float high,
              const ColorMap& colors) {
  Image image(width, height, {"R", "G", "B"});
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float at = high > low ? (values[i] - low) / (high - low) : 0.5f;
    const auto entry = static_cast<std::size_t>(std::lround(255.0f * std::clamp(at, 0.0f, 1.0f)));
    for (std::size_t c = 0; c < 3; ++c) image.pixels[3 * i + c] = static_cast<float>(colors[entry][c]) / 255.0f;
  }
  return image;
}

std::vector<ErrorTile> worst_tiles(const LayerPair& pair, int tile_size, std::size_t count) {
  std::vector<ErrorTile> tiles;
  double all = 0.0;
  for (int y0 = 0; y0 < pair.height; y0 += tile_size)
    for (int x0 = 0; x0 < pair.width; x0 += tile_size) {
      ErrorTile tile{x0, y0, std::min(tile_size, pair.width - x0), std::min(tile_size, pair.height - y0)};
      double sum = 0.0, bias = 0.0, pixels = 0.0;
      for (int y = y0; y < y0 + tile.height; ++y)
        for (int x = x0; x < x0 + tile.width; ++x) {
          const std::size_t i =
              static_cast<std::size_t>(y) * static_cast<std::size_t>(pair.width) + static_cast<std::size_t>(x);
          const C3f &t = pair.test[i], &r = pair.reference[i];
          if (!is_finite(t) || !is_finite(r)) continue;
          pixels += 1.0;
          for (int c = 0; c < 3; ++c) {
            const double e = (static_cast<double>(t[c]) - r[c]) /
                             std::sqrt(static_cast<double>(r[c]) * r[c] + relmse_epsilon);
            sum += e * e / 3.0;
            bias += e / 3.0;
          }
        }
      all += sum;
      if (pixels == 0.0 || sum == 0.0) continue;
      tile.relmse = sum / pixels;
      tile.bias = bias / pixels;
      tile.share = sum;
      tiles.push_back(tile);
    }
  for (ErrorTile& tile : tiles) tile.share /= all;
  const std::size_t kept = std::min(count, tiles.size());
  std::partial_sort(tiles.begin(), tiles.begin() + static_cast<std::ptrdiff_t>(kept), tiles.end(),
                    [](const ErrorTile& a, const ErrorTile& b) { return a.relmse > b.relmse; });
  tiles.resize(kept);
  return tiles;
}

ErrorHistogram error_histogram(std::span<const float> relative) {
  ErrorHistogram histogram;
  for (const float e : relative) {
    const double at =
        e > 0.0f ? (std::log10(e) - ErrorHistogram::lowest_decade) * ErrorHistogram::bins_per_decade : -1.0;
    if (at < 0.0)
      ++histogram.below;
    else if (at >= static_cast<double>(histogram.bins.size()))
      ++histogram.above;
    else
      ++histogram.bins[static_cast<std::size_t>(at)];
  }
  return histogram;
}

}  // namespace twopass
