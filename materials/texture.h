// Colours and numbers that vary over a surface. Knows no file: loaders hand over the pixels.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "render/core/color_matrix.h"
#include "render/image/texture_image.h"

namespace twopass {

/// An affine map of texture coordinates: (u, v) -> (a u + b v + c, d u + e v + f).
struct UvTransform {
  float a = 1.0f, b = 0.0f, c = 0.0f;
  float d = 0.0f, e = 1.0f, f = 0.0f;
  [[nodiscard]] V2f operator()(const V2f& uv) const {
    return {a * uv.x + b * uv.y + c, d * uv.x + e * uv.y + f};
  }
};

/// A point of a triangle of a mesh; barycentric coordinates of corners 1 and 2.
struct MeshPlace {
  std::uint32_t triangle = 0xffffffffu;  ///< this: of none
  V2f barycentric{0.0f, 0.0f};
};

/// Where a texture is looked at.
struct TexturePoint {
  V2f uv;
  /// Extent along u and v of the area that the look-up stands for (M31); 0: the point alone. Never blurs by
  /// more.
  V2f footprint{0.0f, 0.0f};
  MeshPlace place{};  ///< for what is stored with a mesh

  TexturePoint(const V2f& uv_) : uv(uv_) {}  // NOLINT: a point is the simplest area
  TexturePoint(const V2f& uv_, const V2f& footprint_, const MeshPlace& place_ = {})
      : uv(uv_), footprint(footprint_), place(place_) {}
};

/// Squares of half a unit in two colours: `color0` where both coordinates lie in the same half of their unit.
struct Checkerboard {
  C3f color0{0.4f}, color1{0.2f};
  UvTransform to_uv{};
};

enum class TextureFilter { bilinear, nearest };
enum class TextureWrap { repeat, mirror, clamp };

/// What is made of a texel: factor * texel + offset, limited to [lowest, highest].
struct TexelScale {
  C3f factor{1.0f}, offset{0.0f};
  float lowest = -infinity_f, highest = infinity_f;
  bool operator==(const TexelScale&) const = default;
};

/// An image; its first row lies at v = 0.
struct Bitmap {
  std::shared_ptr<const TextureImage> image;  ///< never null but in Udim
  TextureFilter filter = TextureFilter::bilinear;
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
  UvTransform to_uv{};
  std::optional<TexelScale> scale{};
  std::optional<ColorMatrix>
      primaries{};  ///< from those of the image, after the scale; of colours, not of numbers
};

/// Images side by side, one for each unit square of the texture coordinates, as their names tell by number
/// (UDIM): 1001 is that of the first row and column, each further column adds 1, up to ten, each row 10. Rows
/// count upwards, against our v: 1001 has v from 0 to 1, 1011 from -1 to 0. Black where there is none.
struct Udim {
  UvTransform to_uv{};
  std::vector<Bitmap> tiles;  ///< by number - 1001; to_uv of each leads to its own square; `image` may be null
};

/// Colours that are stored with a mesh, linear on each triangle between those of its corners.
struct MeshColors {
  struct Values {
    std::vector<std::array<C3f, 3>> corners;  ///< by triangle
    C3f mean{0.0f};                           ///< over the area of the mesh
  };
  std::string name;                      ///< of the mesh's attribute
  std::shared_ptr<const Values> values;  ///< null until the mesh is known: black
  std::optional<TexelScale> scale{};
  std::optional<ColorMatrix> primaries{};  ///< as in Bitmap
};

/// A colour, the same everywhere, or one of the above. Where a number is wanted, it is the colour's luminance.
using Texture = std::variant<C3f, Checkerboard, Bitmap, Udim, MeshColors>;

/// The mean colour around a point, or the colour there. Coordinates that are not finite read as 0.
C3f color_at(const Texture& texture, const TexturePoint& at);
/// The number: the luminance of the colour; of a grey colour, exactly its value. Checkerboards have their two
/// colours exchanged, as in Mitsuba.
float number_at(const Texture& texture, const TexturePoint& at);
/// Derivatives of number_at by u and v. Of a bitmap, those of its bilinear patch (M27), 0 where it is
/// `nearest`.
V2f gradient_at(const Texture& texture, const TexturePoint& at);
/// Mean over the unit square of the texture's own coordinates, or over the mesh.
C3f mean_color(const Texture& texture);
/// The same where a number is wanted.
float mean_number(const Texture& texture);
/// Width over height of the picture; 1 of textures that are none.
float aspect_of(const Texture& texture);
/// factor * texture + offset, limited to [lowest, highest].
Texture scaled(Texture texture, const TexelScale& scale);
/// The texture of colours in other primaries. REQUIRES: it is in none yet. Not for what is looked at as a
/// number.
Texture in_primaries(Texture texture, const ColorMatrix& primaries);
inline bool is_constant(const Texture& texture) { return std::holds_alternative<C3f>(texture); }

}  // namespace twopass
