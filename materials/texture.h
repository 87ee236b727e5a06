// Colours and numbers that vary over a surface. Knows no file: loaders hand over the pixels.
#pragma once

#include <memory>
#include <variant>

#include "render/image/image.h"

namespace twopass {

/// An affine map of texture coordinates: (u, v) -> (a u + b v + c, d u + e v + f).
struct UvTransform {
  float a = 1.0f, b = 0.0f, c = 0.0f;
  float d = 0.0f, e = 1.0f, f = 0.0f;
  [[nodiscard]] V2f operator()(const V2f& uv) const {
    return {a * uv.x + b * uv.y + c, d * uv.x + e * uv.y + f};
  }
};

/// Squares of half a unit in two colours: `color0` where both coordinates lie in the same half of their unit.
struct Checkerboard {
  C3f color0{0.4f}, color1{0.2f};
  UvTransform to_uv{};
};

enum class TextureFilter { bilinear, nearest };
enum class TextureWrap { repeat, mirror, clamp };

/// An image; its first row lies at v = 0.
struct Bitmap {
  std::shared_ptr<const Image> image;  ///< channels R, G, B: linear, or as stored where `raw` was asked for
  TextureFilter filter = TextureFilter::bilinear;
  TextureWrap wrap = TextureWrap::repeat;
  UvTransform to_uv{};
};

/// A colour, the same everywhere, or one of the above. Where a number is wanted, it is the colour's luminance.
using Texture = std::variant<C3f, Checkerboard, Bitmap>;

/// The colour at texture coordinates `uv`. Coordinates that are not finite read as 0.
C3f color_at(const Texture& texture, const V2f& uv);
/// The number at `uv`: the luminance of the colour; of a grey colour, exactly its value. Checkerboards have their two
/// colours exchanged, as in Mitsuba.
float number_at(const Texture& texture, const V2f& uv);
/// Derivatives of number_at by u and v. Of a bitmap, those of its bilinear patch (M27), 0 where it is
/// `nearest`.
V2f gradient_at(const Texture& texture, const V2f& uv);
/// Mean over the unit square of the texture's own coordinates.
C3f mean_color(const Texture& texture);
inline bool is_constant(const Texture& texture) { return std::holds_alternative<C3f>(texture); }

}  // namespace twopass
