// A picture that a light throws: colours on a grid, smoothly interpolated.
#pragma once

#include <vector>

#include "render/core/types.h"
#include "render/image/image.h"

namespace twopass {

/// Linear Rec.709 factors, 0 or more.
class LightTexture {
 public:
  /// Negative and non-finite values become 0. REQUIRES: at least one pixel, and R, G, B or Y.
  explicit LightTexture(const Image& image);
  /// One colour everywhere.
  explicit LightTexture(const C3f& color) : pixels_{color} {}

  /// Bilinear between the centres of pixels, repeated beyond the borders, as Mitsuba's bitmaps are. (0, 0) is
  /// the upper left corner of the picture, (1, 1) the lower right. REQUIRES: uv in [0, 1]^2.
  [[nodiscard]] C3f lookup(const V2f& uv) const;
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// Mean over all pixels.
  [[nodiscard]] C3f mean() const;
  [[nodiscard]] const std::vector<C3f>& pixels() const { return pixels_; }

 private:
  [[nodiscard]] const C3f& pixel(int x, int y) const;

  int width_ = 1, height_ = 1;
  std::vector<C3f> pixels_;  // rows from top to bottom
};

}  // namespace twopass
