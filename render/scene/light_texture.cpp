#include "render/scene/light_texture.h"

namespace twopass {

LightTexture::LightTexture(const Image& image)
    : width_(image.width), height_(image.height), pixels_(rgb_pixels(image)) {
  for (C3f& color : pixels_)
    for (int c = 0; c < 3; ++c)
      if (!(std::isfinite(color[c]) && color[c] > 0.0f)) color[c] = 0.0f;
}

const C3f& LightTexture::pixel(int x, int y) const {
  // At most one step beyond the border.
  x = x < 0 ? x + width_ : x >= width_ ? x - width_ : x;
  y = y < 0 ? y + height_ : y >= height_ ? y - height_ : y;
  return pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
}

C3f LightTexture::lookup(const V2f& uv) const {
  const float x = uv.x * static_cast<float>(width_) - 0.5f, y = uv.y * static_cast<float>(height_) - 0.5f;
  const float x0 = std::floor(x), y0 = std::floor(y), fx = x - x0, fy = y - y0;
  const int i = static_cast<int>(x0), j = static_cast<int>(y0);
  return (pixel(i, j) * (1.0f - fx) + pixel(i + 1, j) * fx) * (1.0f - fy) +
         (pixel(i, j + 1) * (1.0f - fx) + pixel(i + 1, j + 1) * fx) * fy;
}

C3f LightTexture::mean() const {
  C3d sum(0.0);
  for (const C3f& color : pixels_) sum += C3d(color);
  return C3f(sum / static_cast<double>(pixels_.size()));
}

}  // namespace twopass
