// The layers of a film beside its picture: sums by pixel, that can be read, restored and added up. Knows no
// scene and no file.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/image/image.h"

namespace twopass {

/// How the samples of a pixel become its value.
enum class Reduction : std::uint8_t {
  mean,     ///< as the picture itself: by the same filter, weights and estimator, so that sums stay sums
  total,    ///< added up, unfiltered
  nearest,  ///< the sample nearest to the pixel's centre has it: what cannot be averaged
  samples,  ///< no values of its own: the number of samples
  variance  ///< no values of its own: the estimated variance of the pixel's mean, by channel
};

/// One layer: a name, a channel for each of its values.
struct FilmLayer {
  std::string name;                   ///< before the dot; empty: the channels stand for themselves
  std::vector<std::string> channels;  ///< behind the dot: R G B, X Y Z ...
  Reduction reduction = Reduction::mean;
};

/// What a pixel's layers are resolved by.
struct PixelTotals {
  double weight = 0.0;  ///< sum of the filter's weights
  std::uint64_t samples = 0;
  C3d variance{0.0, 0.0, 0.0};  ///< of the mean radiance
};

/// "layer.channel", or the channel alone.
std::string channel_name(const FilmLayer& layer, std::size_t channel);

/// The samples of layers, pixel by pixel. One thread owns a pixel while a pass is rendered, hence no locks.
///
/// A pixel is a row of numbers that are enough to go on with it: `raw_names()` says what they are, `raw(pixel)`
/// gives them to be read and to be put back. Memory: 8 bytes each.
class FilmLayers {
 public:
  FilmLayers() = default;
  /// All zeros. `has_signed_weights`: the filter's weights are not all 1, as those of kernels with negative
  /// lobes; means then need a second sum (FilmPixel).
  FilmLayers(std::size_t pixels, std::vector<FilmLayer> layers, bool has_signed_weights);

  [[nodiscard]] const std::vector<FilmLayer>& layers() const { return layers_; }
  [[nodiscard]] bool empty() const { return layers_.empty(); }
  /// Values a sample brings: one a channel, layer by layer, but for layers without values of their own.
  [[nodiscard]] std::size_t value_count() const { return values_; }
  /// Bytes a pixel of such layers.
  [[nodiscard]] static std::size_t bytes_per_pixel(std::span<const FilmLayer> layers, bool has_signed_weights);

  /// Adds a sample: its values, the weight of its FilterSample and its squared distance from the pixel's
  /// centre. Values that are not finite count as 0. REQUIRES: value_count() values.
  void add(std::size_t pixel, std::span<const float> values, float weight, float distance2);
  /// Adds the samples of a pixel of another film with the same layers. Order changes only rounding.
  void merge(std::size_t pixel, std::span<const double> raw);

  /// Names of the numbers that a pixel consists of, such as "diffuse_direct.R", and "diffuse_direct.R/plain"
  /// for a second sum, "nearest/distance2" for the sample that `nearest` values are of (infinite: none yet).
  [[nodiscard]] std::vector<std::string> raw_names() const;
  [[nodiscard]] std::size_t raw_count() const { return stride_; }
  [[nodiscard]] std::span<double> raw(std::size_t pixel) { return {raw_.data() + pixel * stride_, stride_}; }
  [[nodiscard]] std::span<const double> raw(std::size_t pixel) const {
    return {raw_.data() + pixel * stride_, stride_};
  }

  /// The pixel's value in each channel, layer by layer; zeros without samples. REQUIRES: room for
  /// channel_count() values.
  void resolve(std::size_t pixel, const PixelTotals& totals, std::span<float> values) const;
  /// Channels of all layers.
  [[nodiscard]] std::size_t channel_count() const { return reductions_.size(); }

 private:
  std::vector<FilmLayer> layers_;
  std::vector<Reduction> reductions_;  // by channel
  bool has_signed_weights_ = false, has_nearest_ = false;
  std::size_t values_ = 0, stride_ = 0;
  std::vector<double> raw_;
};

}  // namespace twopass
