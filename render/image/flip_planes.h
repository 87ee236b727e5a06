// The two tools of FLIP: separable filters on single-channel pictures, and its colour spaces.
#pragma once

#include <span>
#include <vector>

#include "render/core/types.h"

namespace twopass {

/// One channel of some rows of a picture, row by row.
struct Plane {
  int width = 0;
  int height = 0;
  std::vector<float> values;

  Plane(int width_, int height_)
      : width(width_),
        height(height_),
        values(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}
  [[nodiscard]] float* row(int y) { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
  [[nodiscard]] const float* row(int y) const { return values.data() + static_cast<std::ptrdiff_t>(y) * width; }
};

/// Weights for offsets -radius ... radius; the size is odd.
using Kernel = std::vector<float>;

/// Convolves along the rows (correlation: weight k applies to x + k); the border repeats its last value.
Plane filter_rows(const Plane& in, const Kernel& kernel);
/// Filters along the columns and keeps the rows `skip` ... in.height - skip - 1 only.
/// REQUIRES: the kernel's radius is at most `skip`, so that no row outside is needed.
Plane filter_columns(const Plane& in, const Kernel& kernel, int skip);

/// Linear sRGB to YCxCz, the linear opponent space: 116 Y - 16, 500 (X - Y), 200 (Y - Z), with X, Y, Z relative
/// to the D65 white.
C3f linear_to_ycxcz(const C3f& rgb);
C3f ycxcz_to_linear(const C3f& ycxcz);
/// Linear sRGB to CIELAB (D65) with chroma a, b scaled by 0.01 L: colourfulness grows with luminance (Hunt).
C3f linear_to_hunt_lab(const C3f& rgb);
/// HyAB distance |dL| + |(da, db)| (Abasi, Amani Tehran, Fairchild 2020).
float hyab(const C3f& a, const C3f& b);

}  // namespace twopass
