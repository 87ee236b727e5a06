// A picture of the whole surroundings, latitude by longitude, as light: Mitsuba's `envmap` (L24, L25).
#pragma once

#include <variant>
#include <vector>

#include <Imath/half.h>

#include "render/core/types.h"
#include "render/image/image.h"

namespace twopass {

/// How an environment map is turned and sampled.
struct EnvironmentMapOptions {
  float scale = 1.0f;             ///< of the radiance
  M44d to_world{};                ///< of directions: rotations and flips
  bool mis_compensation = false;  ///< samples less where it is darker than the mean (Karlik et al. 2019)
};

/// Radiance that arrives from each direction, bilinear between pixels, and samples in proportion to its
/// luminance. In its own frame +y is up, the picture's middle column shows +z, its left quarter +x; the first
/// row is the zenith, the last the nadir. Const and thread-safe. 10 bytes a pixel where all values are exactly
/// those of half-precision numbers, as in most files, else 16.
class EnvironmentMap {
 public:
  /// A direction drawn, and what there is to see.
  struct Drawn {
    V3f direction;
    C3f radiance;
    float pdf_w;
  };

  /// Values that are negative or not finite become 0. `where` names the picture in errors. Throws Error when it
  /// is smaller than 2x3 pixels or has no colours. REQUIRES: options.to_world keeps lengths and angles.
  EnvironmentMap(const Image& image, const EnvironmentMapOptions& options, std::string_view where);

  [[nodiscard]] C3f radiance(const V3f& direction) const;
  /// Nothing is drawn (pdf 0) from a map that is black.
  [[nodiscard]] Drawn sample(const V2f& u) const;
  [[nodiscard]] float pdf_w(const V3f& direction) const;
  [[nodiscard]] const C3f& mean_radiance() const { return mean_; }
  [[nodiscard]] std::uint64_t fingerprint() const { return fingerprint_; }
  [[nodiscard]] bool is_half() const { return std::holds_alternative<std::vector<half>>(pixels_); }

 private:
  // A point of the picture between four pixels: columns x0 and x1, rows y and y + 1.
  struct Spot {
    std::size_t x0, x1, y;
    float fx, fy;
  };
  [[nodiscard]] Spot spot(const V3f& local) const;
  [[nodiscard]] C3f pixel(std::size_t x, std::size_t y) const;
  [[nodiscard]] C3f interpolated(const Spot& spot) const;
  // What samples are proportional to at a pixel, and between pixels (L25).
  [[nodiscard]] double weight(std::size_t x, std::size_t y) const;
  [[nodiscard]] double density(const Spot& spot) const;
  [[nodiscard]] float pdf_w(const Spot& spot, float sin_theta) const;

  void store(const std::vector<C3f>& colors);
  void measure(bool mis_compensation);
  void prepare_sampling();

  std::size_t width_, height_;
  float scale_;
  V3f axes_[3];                                                 // local x, y, z in the world
  std::variant<std::vector<half>, std::vector<float>> pixels_;  // three a pixel, unscaled
  float dark_ = 0.0f;                                           // luminance below which nothing is sampled
  std::vector<float> sin_theta_;        // by row; of the poles, the mean over the half row that they stand for
  std::vector<double> row_sum_;         // of weights, by row
  std::vector<double> row_cumulative_;  // integral of the density over rows before each, in pixels
  std::vector<float> cumulative_;       // by row and column: the same along a row, as a fraction of its sum
  C3f mean_{0.0f};
  std::uint64_t fingerprint_ = 0;
};

}  // namespace twopass
