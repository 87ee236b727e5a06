#include "render/image/film_layers.h"

#include <cmath>
#include <limits>

namespace twopass {

namespace {

constexpr double nothing_yet = std::numeric_limits<double>::infinity();

bool has_values(Reduction reduction) {
  return reduction != Reduction::samples && reduction != Reduction::variance;
}

// Numbers that stand for one value.
std::size_t raw_size(Reduction reduction, bool has_signed_weights) {
  if (!has_values(reduction)) return 0;
  return reduction == Reduction::mean && has_signed_weights ? 2 : 1;
}

bool has_nearest(std::span<const FilmLayer> layers) {
  for (const FilmLayer& layer : layers)
    if (layer.reduction == Reduction::nearest) return true;
  return false;
}

}  // namespace

std::string channel_name(const FilmLayer& layer, std::size_t channel) {
  return layer.name.empty() ? layer.channels[channel] : layer.name + "." + layer.channels[channel];
}

std::size_t FilmLayers::bytes_per_pixel(std::span<const FilmLayer> layers, bool has_signed_weights) {
  std::size_t count = has_nearest(layers) ? 1 : 0;
  for (const FilmLayer& layer : layers)
    count += layer.channels.size() * raw_size(layer.reduction, has_signed_weights);
  return count * sizeof(double);
}

FilmLayers::FilmLayers(std::size_t pixels, std::vector<FilmLayer> layers, bool has_signed_weights)
    : layers_(std::move(layers)), has_signed_weights_(has_signed_weights), has_nearest_(has_nearest(layers_)) {
  for (const FilmLayer& layer : layers_)
    reductions_.insert(reductions_.end(), layer.channels.size(), layer.reduction);
  for (const Reduction reduction : reductions_) values_ += has_values(reduction) ? 1 : 0;
  stride_ = bytes_per_pixel(layers_, has_signed_weights) / sizeof(double);
  raw_.resize(pixels * stride_);
  if (has_nearest_)
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) raw(pixel).back() = nothing_yet;
}

void FilmLayers::add(std::size_t pixel, std::span<const float> values, float weight, float distance2) {
  const std::span<double> at = raw(pixel);
  const bool is_nearest = has_nearest_ && distance2 < at.back();
  if (is_nearest) at.back() = distance2;
  std::size_t next = 0, i = 0;
  for (const Reduction reduction : reductions_) {
    if (!has_values(reduction)) continue;
    const float given = values[i++];
    const double value = std::isfinite(given) ? given : 0.0;
    if (reduction == Reduction::nearest) {
      if (is_nearest) at[next] = value;
      ++next;
    } else if (reduction == Reduction::total) {
      at[next++] += value;
    } else {
      at[next++] += value * weight;
      if (has_signed_weights_) at[next++] += value;
    }
  }
}

void FilmLayers::merge(std::size_t pixel, std::span<const double> other) {
  const std::span<double> at = raw(pixel);
  const bool is_nearest = has_nearest_ && other.back() < at.back();
  if (is_nearest) at.back() = other.back();
  std::size_t next = 0;
  for (const Reduction reduction : reductions_)
    for (std::size_t k = 0; k < raw_size(reduction, has_signed_weights_); ++k, ++next) {
      if (reduction != Reduction::nearest)
        at[next] += other[next];
      else if (is_nearest)
        at[next] = other[next];
    }
}

std::vector<std::string> FilmLayers::raw_names() const {
  std::vector<std::string> names;
  for (const FilmLayer& layer : layers_)
    for (std::size_t c = 0; c < layer.channels.size(); ++c) {
      const std::size_t size = raw_size(layer.reduction, has_signed_weights_);
      if (size > 0) names.push_back(channel_name(layer, c));
      if (size > 1) names.push_back(names.back() + "/plain");
    }
  if (has_nearest_) names.emplace_back("nearest/distance2");
  return names;
}

void FilmLayers::resolve(std::size_t pixel, const PixelTotals& totals, std::span<float> values) const {
  const std::span<const double> at = raw(pixel);
  const double n = static_cast<double>(totals.samples),
               excess = totals.samples == 0 ? 0.0 : totals.weight / n - 1.0;
  std::size_t next = 0, i = 0;
  for (const FilmLayer& layer : layers_)
    for (std::size_t c = 0; c < layer.channels.size(); ++c) {
      double value = 0.0;
      if (has_values(layer.reduction)) value = at[next++];
      if (layer.reduction == Reduction::samples) value = n;
      if (layer.reduction == Reduction::variance) value = totals.variance[static_cast<int>(c)];
      if (layer.reduction == Reduction::mean) {
        // The estimator of FilmPixel::mean.
        if (has_signed_weights_) value -= at[next++] * excess;
        value = totals.samples == 0 ? 0.0 : value / n;
      }
      values[i++] = static_cast<float>(value);
    }
}

}  // namespace twopass
