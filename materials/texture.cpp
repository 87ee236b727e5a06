#include "materials/texture.h"

namespace twopass {

namespace {

float grey(const C3f& c) { return c.x == c.y && c.y == c.z ? c.x : luminance(c); }

// The texel that stands for an index beyond the image.
int wrapped(int i, int size, TextureWrap wrap) {
  if (static_cast<unsigned>(i) < static_cast<unsigned>(size)) return i;
  if (wrap == TextureWrap::clamp) return std::clamp(i, 0, size - 1);
  const int period = wrap == TextureWrap::repeat ? size : 2 * size;
  i %= period;
  if (i < 0) i += period;
  return i < size ? i : period - 1 - i;
}

C3f texel(const Bitmap& bitmap, int x, int y) {
  const Image& image = *bitmap.image;
  const float* at =
      &image
           .pixels[image.index(wrapped(x, image.width, bitmap.wrap), wrapped(y, image.height, bitmap.wrap), 0)];
  return image.channels.size() >= 3 ? C3f(at[0], at[1], at[2]) : C3f(at[0]);
}

// The four texels around a point, and how far it lies between them.
struct Patch {
  C3f c00, c10, c01, c11;
  float x, y;
};

// Beyond this the fraction of a texel is lost, and integers overflow further on.
constexpr float largest_coordinate = 1e8f;

V2f pixel_coordinates(const Bitmap& bitmap, const V2f& uv) {
  const V2f at = bitmap.to_uv(uv);
  const V2f pixel(at.x * static_cast<float>(bitmap.image->width),
                  at.y * static_cast<float>(bitmap.image->height));
  const bool is_valid = std::abs(pixel.x) < largest_coordinate && std::abs(pixel.y) < largest_coordinate;
  return is_valid ? pixel : V2f(0.0f, 0.0f);
}

Patch patch_at(const Bitmap& bitmap, const V2f& uv) {
  const V2f pixel = pixel_coordinates(bitmap, uv) - V2f(0.5f, 0.5f);
  const float x = std::floor(pixel.x), y = std::floor(pixel.y);
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  return {texel(bitmap, i, j),
          texel(bitmap, i + 1, j),
          texel(bitmap, i, j + 1),
          texel(bitmap, i + 1, j + 1),
          pixel.x - x,
          pixel.y - y};
}

C3f color_of(const C3f& color, const V2f&) { return color; }

C3f color_of(const Checkerboard& checkerboard, const V2f& uv) {
  const V2f at = checkerboard.to_uv(uv);
  const bool is_right = at.x - std::floor(at.x) > 0.5f, is_upper = at.y - std::floor(at.y) > 0.5f;
  return is_right == is_upper ? checkerboard.color0 : checkerboard.color1;
}

C3f color_of(const Bitmap& bitmap, const V2f& uv) {
  if (bitmap.filter == TextureFilter::nearest) {
    const V2f pixel = pixel_coordinates(bitmap, uv);
    return texel(bitmap, static_cast<int>(std::floor(pixel.x)), static_cast<int>(std::floor(pixel.y)));
  }
  const Patch p = patch_at(bitmap, uv);
  const C3f lower = p.c00 * (1.0f - p.x) + p.c10 * p.x, upper = p.c01 * (1.0f - p.x) + p.c11 * p.x;
  return lower * (1.0f - p.y) + upper * p.y;
}

}  // namespace

C3f color_at(const Texture& texture, const V2f& uv) {
  return std::visit([&](const auto& kind) { return color_of(kind, uv); }, texture);
}

float number_at(const Texture& texture, const V2f& uv) {
  // Mitsuba exchanges the two where a number is wanted; scenes made with it rely on that.
  if (const auto* checkerboard = std::get_if<Checkerboard>(&texture)) {
    const Checkerboard exchanged{checkerboard->color1, checkerboard->color0, checkerboard->to_uv};
    return grey(color_of(exchanged, uv));
  }
  return grey(color_at(texture, uv));
}

V2f gradient_at(const Texture& texture, const V2f& uv) {
  const auto* bitmap = std::get_if<Bitmap>(&texture);
  if (!bitmap || bitmap->filter == TextureFilter::nearest) return {0.0f, 0.0f};
  const Patch p = patch_at(*bitmap, uv);
  const float f00 = grey(p.c00), f10 = grey(p.c10), f01 = grey(p.c01), f11 = grey(p.c11);
  const float by_x =
      ((1.0f - p.y) * (f10 - f00) + p.y * (f11 - f01)) * static_cast<float>(bitmap->image->width);
  const float by_y =
      ((1.0f - p.x) * (f01 - f00) + p.x * (f11 - f10)) * static_cast<float>(bitmap->image->height);
  const UvTransform& m = bitmap->to_uv;
  return {m.a * by_x + m.d * by_y, m.b * by_x + m.e * by_y};
}

C3f mean_color(const Texture& texture) {
  if (const auto* color = std::get_if<C3f>(&texture)) return *color;
  if (const auto* checkerboard = std::get_if<Checkerboard>(&texture))
    return (checkerboard->color0 + checkerboard->color1) * 0.5f;
  const Bitmap& bitmap = std::get<Bitmap>(texture);
  C3d sum(0.0);
  for (int y = 0; y < bitmap.image->height; ++y)
    for (int x = 0; x < bitmap.image->width; ++x) sum += C3d(texel(bitmap, x, y));
  return C3f(sum * (1.0 / static_cast<double>(std::max<std::size_t>(1, bitmap.image->pixel_count()))));
}

}  // namespace twopass
