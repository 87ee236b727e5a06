// The film: sums of samples for each pixel, and from them the picture and an estimate of its error.
// Knows no scene and no file. One thread owns a pixel while a pass is rendered, hence no locks.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "render/core/types.h"
#include "render/image/cryptomatte.h"
#include "render/image/film_layers.h"
#include "render/image/image.h"

namespace twopass {

/// Mean radiances of the pixels around one.
struct Around {
  C3d sum{0.0, 0.0, 0.0};
  int count = 0;

  void operator+=(const Around& other) {
    sum += other.sum;
    count += other.count;
  }
};

/// What a pixel's batches say of one sample, before it is seen among the pixels around.
struct PixelNoise {
  C3d mean, variance;
  C3d certain;  ///< the mean, two standard errors below

  /// Variance over r^2 + 0.01 (S9), averaged over the channels; divided by the samples it is the expected
  /// relMSE of the mean. r is the pixel's mean radiance, but only as far as it is certain or as the pixels
  /// around have it: a rare bright sample raises the mean of its pixel together with the variance, and would
  /// hide itself. Never NaN.
  [[nodiscard]] double relative(const Around& around) const;
};

/// What a pixel has received, from one batch of samples or from many.
///
/// Weights are 1 on average but for kernels with negative lobes not always, and then a mean of weight *
/// radiance is noisy even where the picture is flat. Hence a control variate: of n samples f with weights w,
/// the mean is
///     (sum w f - (sum w / n - 1) sum f) / n,
/// which is exact for constant f, needs no division by a sum that may vanish, is the plain mean where all
/// weights are 1, and has a bias of (E f - E w f) / n.
struct FilmPixel {
  C3d sum{0.0, 0.0, 0.0};     ///< of weight * radiance, W/(m2 sr), linear Rec.709
  C3d plain{0.0, 0.0, 0.0};   ///< of radiance
  double alpha = 0.0;         ///< sum of weight * coverage
  double plain_alpha = 0.0;   ///< sum of coverage
  double weight = 0.0;        ///< sum of the filter's weights
  C3d spread{0.0, 0.0, 0.0};  ///< sum over batches of samples * (mean of the batch - mean of all)^2
  std::uint64_t samples = 0;
  std::uint32_t batches = 0;

  /// The pixel's mean radiance; black without samples. May be negative beside something bright, where the
  /// kernel is.
  [[nodiscard]] C3d mean() const;
  /// Mean coverage, in [0, 1]; 0 without samples.
  [[nodiscard]] double mean_alpha() const;
  /// What stands in the picture: R, G, B, A.
  [[nodiscard]] std::array<float, 4> resolved() const;
  /// From the scatter of the batches. REQUIRES: batches >= 2.
  [[nodiscard]] PixelNoise noise() const;
  /// Adds what another set of batches found. Exact (Chan, Golub, LeVeque 1983) where weights are 1, `spread` a
  /// good estimate where not; order changes only rounding.
  void merge(const FilmPixel& other);
};

/// The samples of one pixel in one pass.
class PixelBatch {
 public:
  /// Adds a sample: radiance W/(m2 sr), alpha in [0,1], weight of FilterSample.
  /// A sample that is not finite counts as black with alpha 0; then the result is false, for the caller to
  /// count.
  bool add(const C3f& radiance, float alpha = 1.0f, float weight = 1.0f);
  [[nodiscard]] const FilmPixel& sums() const { return sums_; }

 private:
  FilmPixel sums_;
};

/// An estimate of a picture's error, and how sure it is.
struct NoiseEstimate {
  double relmse;          ///< expected
  double standard_error;  ///< of that
  /// The root of the relMSE that it exceeds with a probability of about 2 %.
  [[nodiscard]] double upper_bound() const { return std::sqrt(relmse + 2.0 * standard_error); }
};

/// What a film keeps beside the picture.
struct FilmLayout {
  std::vector<FilmLayer> layers{};
  std::vector<std::string> cryptomattes{};  ///< names of layers such as "CryptoObject"
  bool has_signed_weights = false;          ///< the filter has negative lobes

  /// Names of all channels of a resolved film: R, G, B, A and what follows.
  [[nodiscard]] std::vector<std::string> channels() const;
  /// Bytes a pixel, but for the things that Cryptomatte finds: 24 and 16 for each that a pixel sees.
  [[nodiscard]] std::size_t bytes_per_pixel() const;
};

class Film {
 public:
  /// An empty film. Throws Error as check().
  Film(int width, int height, FilmLayout layout = {});
  /// For use before any work: throws Error unless both sizes are at least 1 and the film has at most 2^30
  /// pixels (32k x 32k), for which the machine has the memory.
  static void check(int width, int height, const FilmLayout& layout);
  /// The memory that it takes to render and to write a picture, however many samples it has; Cryptomatte's
  /// things excepted.
  [[nodiscard]] static double bytes_to_render(int width, int height, const FilmLayout& layout = {});

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  /// Adds one pass's samples of one pixel. Different pixels may be added from different threads.
  /// REQUIRES: 0 <= x < width, 0 <= y < height.
  void add_pixel(int x, int y, const PixelBatch& batch) { merge_pixel(x, y, batch.sums()); }
  /// Adds what another film, or a file, holds of a pixel. Same requirements.
  void merge_pixel(int x, int y, const FilmPixel& other) { pixels_[index(x, y)].merge(other); }
  /// Adds all pixels of a film, its layers included. Throws Error when the sizes or the layers differ.
  void merge(const Film& other);

  [[nodiscard]] const FilmPixel& pixel(int x, int y) const { return pixels_[index(x, y)]; }
  /// All samples taken so far.
  [[nodiscard]] std::uint64_t samples() const;

  [[nodiscard]] const FilmLayout& layout() const { return layout_; }
  /// The layers, by number of the pixel, which is row by row from the top.
  [[nodiscard]] FilmLayers& layers() { return layers_; }
  [[nodiscard]] const FilmLayers& layers() const { return layers_; }
  /// In the order of the layout.
  [[nodiscard]] std::vector<CryptoFilm>& cryptomattes() { return cryptomattes_; }
  [[nodiscard]] const std::vector<CryptoFilm>& cryptomattes() const { return cryptomattes_; }

  /// The picture with all of its layers: R, G, B, A, the layers' channels in their order, and of each
  /// Cryptomatte
  /// "<name>00.R" and so on. Without layers the same as resolve().
  [[nodiscard]] Image resolve_all() const;
  /// The picture: channels R, G, B, A. Pixels without samples are black with alpha 0.
  [[nodiscard]] Image resolve() const;

  /// The error by the scatter of the batches (S9): mean over sampled pixels and channels of
  /// Var(mean) / (r^2 + 0.01). Never NaN; infinite while a sampled pixel has fewer than two batches, or none is
  /// sampled. Batches of a stratified sampler scatter more than their sum errs, so the estimate is then on the
  /// safe side.
  [[nodiscard]] NoiseEstimate noise() const;
  /// The root of the same relMSE.
  [[nodiscard]] double relative_error() const { return std::sqrt(noise().relmse); }
  /// The sampled pixels of the 5x5 around each pixel, without itself; row by row.
  [[nodiscard]] std::vector<Around> surroundings() const;
  static constexpr int around_radius = 2;

  /// The number of a pixel. REQUIRES: 0 <= x < width, 0 <= y < height.
  [[nodiscard]] std::size_t index(int x, int y) const;

 private:
  int width_;
  int height_;
  FilmLayout layout_;
  std::vector<FilmPixel> pixels_;
  FilmLayers layers_;
  std::vector<CryptoFilm> cryptomattes_;
};

}  // namespace twopass
