#include "materials/texture.h"

#include <bit>

namespace twopass {

namespace {

float grey(const C3f& c) { return c.x == c.y && c.y == c.z ? c.x : luminance(c); }

C3f adjusted(const TexelScale& scale, const C3f& texel) {
  C3f c = scale.factor * texel + scale.offset;
  for (int i = 0; i < 3; ++i) c[i] = std::clamp(c[i], scale.lowest, scale.highest);
  return c;
}
C3f adjusted(const std::optional<TexelScale>& scale, const C3f& texel) {
  return scale ? adjusted(*scale, texel) : texel;
}

// The colour that is made of a texel.
template <class Kind>
C3f finished(const Kind& texture, const C3f& texel) {
  const C3f color = adjusted(texture.scale, texel);
  return texture.primaries ? (*texture.primaries)(color) : color;
}

// The texel that stands for an index beyond the image.
int wrapped(int i, int size, TextureWrap wrap) {
  if (static_cast<unsigned>(i) < static_cast<unsigned>(size)) return i;
  if (wrap == TextureWrap::clamp) return std::clamp(i, 0, size - 1);
  const int period = wrap == TextureWrap::repeat ? size : 2 * size;
  i %= period;
  if (i < 0) i += period;
  return i < size ? i : period - 1 - i;
}

// That of the texel beside it. `at` is the index wrapped already, which saves a division.
int wrapped_next(int i, int at, int size, TextureWrap wrap) {
  if (wrap == TextureWrap::repeat) return at + 1 < size ? at + 1 : 0;
  return wrapped(i + 1, size, wrap);
}

// Extent of a footprint along the texture's own coordinates; at least, where these are turned.
V2f extent_of(const UvTransform& m, const V2f& footprint) {
  return {std::max(std::abs(m.a) * footprint.x, std::abs(m.b) * footprint.y),
          std::max(std::abs(m.e) * footprint.y, std::abs(m.d) * footprint.x)};
}

// The coarsest level whose texels are no larger than the footprint, along the shorter of its sides (M31).
int level_for(const Bitmap& bitmap, const V2f& footprint) {
  if (!(footprint.x > 0.0f && footprint.y > 0.0f)) return 0;
  const V2f extent = extent_of(bitmap.to_uv, footprint);
  const TextureImage& image = *bitmap.image;
  const float texels =
      std::min(extent.x * static_cast<float>(image.width()), extent.y * static_cast<float>(image.height()));
  if (!(texels >= 2.0f)) return 0;
  const int exponent = static_cast<int>(std::bit_cast<std::uint32_t>(texels) >> 23) - 127;
  return std::min(exponent, image.level_count() - 1);
}

// Beyond this the fraction of a texel is lost, and integers overflow further on.
constexpr float largest_coordinate = 1e8f;

// A point in units of the texels of a level.
V2f texel_coordinates(const Bitmap& bitmap, const V2i& size, const V2f& uv) {
  const V2f at = bitmap.to_uv(uv);
  const V2f texel(at.x * static_cast<float>(size.x), at.y * static_cast<float>(size.y));
  const bool is_valid = std::abs(texel.x) < largest_coordinate && std::abs(texel.y) < largest_coordinate;
  return is_valid ? texel : V2f(0.0f, 0.0f);
}

// The columns and rows of the four texels around a point, and how far it lies between them.
struct Patch {
  V2i columns, rows;
  V2f at;
};

Patch patch_at(const Bitmap& bitmap, int level, const V2f& uv) {
  const V2i size = bitmap.image->size(level);
  const V2f at = texel_coordinates(bitmap, size, uv) - V2f(0.5f, 0.5f);
  const float x = std::floor(at.x), y = std::floor(at.y);
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const int column = wrapped(i, size.x, bitmap.wrap_u), row = wrapped(j, size.y, bitmap.wrap_v);
  const V2i columns(column, wrapped_next(i, column, size.x, bitmap.wrap_u));
  const V2i rows(row, wrapped_next(j, row, size.y, bitmap.wrap_v));
  return {columns, rows, {at.x - x, at.y - y}};
}

C3f color_of(const C3f& color, const TexturePoint&) { return color; }

// Mean over an interval of the wave that is -1 in the first half of each unit and 1 in the second.
float mean_of_wave(float middle, float extent) {
  const auto fraction = [](float x) { return x - std::floor(x); };
  const float x = fraction(middle);
  if (!(extent > 1e-4f)) return x > 0.5f ? 1.0f : -1.0f;
  const auto integral = [&](float end) { return std::abs(fraction(end) - 0.5f); };  // over whole units it is 0
  return std::clamp((integral(x + 0.5f * extent) - integral(x - 0.5f * extent)) / extent, -1.0f, 1.0f);
}

C3f color_of(const Checkerboard& checkerboard, const TexturePoint& point) {
  const V2f at = checkerboard.to_uv(point.uv);
  const V2f extent = extent_of(checkerboard.to_uv, point.footprint);
  const float same = mean_of_wave(at.x, extent.x) * mean_of_wave(at.y, extent.y);
  if (same == 1.0f) return checkerboard.color0;
  if (same == -1.0f) return checkerboard.color1;
  return checkerboard.color0 * (0.5f + 0.5f * same) + checkerboard.color1 * (0.5f - 0.5f * same);
}

C3f color_of(const Bitmap& bitmap, const TexturePoint& at) {
  const int level = level_for(bitmap, at.footprint);
  if (bitmap.filter == TextureFilter::nearest) {
    const V2i size = bitmap.image->size(level);
    const V2f texel = texel_coordinates(bitmap, size, at.uv);
    return finished(bitmap, bitmap.image->texel(
                                level, wrapped(static_cast<int>(std::floor(texel.x)), size.x, bitmap.wrap_u),
                                wrapped(static_cast<int>(std::floor(texel.y)), size.y, bitmap.wrap_v)));
  }
  const Patch p = patch_at(bitmap, level, at.uv);
  return finished(bitmap, bitmap.image->mix(level, p.columns, p.rows, p.at));
}

// The tile at a point; an edge between two belongs to the first. Null: there is none.
const Bitmap* tile_at(const Udim& udim, const V2f& uv) {
  const V2f at = udim.to_uv(uv);
  const float column = std::max(0.0f, std::ceil(at.x) - 1.0f),
              row = std::max(0.0f, std::ceil(1.0f - at.y) - 1.0f);  // 0 also for what is no number
  if (!(column < 10.0f && row < 1e6f)) return nullptr;
  const std::size_t number = static_cast<std::size_t>(row) * 10 + static_cast<std::size_t>(column);
  return number < udim.tiles.size() && udim.tiles[number].image ? &udim.tiles[number] : nullptr;
}

C3f color_of(const Udim& udim, const TexturePoint& at) {
  const Bitmap* tile = tile_at(udim, at.uv);
  return tile ? color_of(*tile, at) : C3f(0.0f);
}

C3f color_of(const MeshColors& colors, const TexturePoint& at) {
  if (!colors.values || at.place.triangle >= colors.values->corners.size()) return C3f(0.0f);
  const std::array<C3f, 3>& corner = colors.values->corners[at.place.triangle];
  const V2f& b = at.place.barycentric;
  return finished(colors, corner[0] * (1.0f - b.x - b.y) + corner[1] * b.x + corner[2] * b.y);
}

// The second scale after the first, whose limits are those of what is already in range.
std::optional<TexelScale> combined(const std::optional<TexelScale>& first, const TexelScale& second) {
  if (!first) return second;
  return TexelScale{first->factor * second.factor, first->offset * second.factor + second.offset, second.lowest,
                    second.highest};
}

}  // namespace

C3f color_at(const Texture& texture, const TexturePoint& at) {
  return std::visit([&](const auto& kind) { return color_of(kind, at); }, texture);
}

float number_at(const Texture& texture, const TexturePoint& at) {
  // Mitsuba exchanges the two where a number is wanted; scenes made with it rely on that.
  if (const auto* checkerboard = std::get_if<Checkerboard>(&texture)) {
    const Checkerboard exchanged{checkerboard->color1, checkerboard->color0, checkerboard->to_uv};
    return grey(color_of(exchanged, at));
  }
  return grey(color_at(texture, at));
}

V2f gradient_at(const Texture& texture, const TexturePoint& at) {
  const auto* bitmap = std::get_if<Bitmap>(&texture);
  if (const auto* udim = std::get_if<Udim>(&texture)) bitmap = tile_at(*udim, at.uv);
  if (!bitmap || bitmap->filter == TextureFilter::nearest) return {0.0f, 0.0f};
  const int level = level_for(*bitmap, at.footprint);
  const V2i size = bitmap->image->size(level);
  const Patch p = patch_at(*bitmap, level, at.uv);
  const TexelPatch texels = bitmap->image->patch(level, p.columns, p.rows);
  const auto number = [&](const C3f& texel) { return grey(adjusted(bitmap->scale, texel)); };
  const float f00 = number(texels.c00), f10 = number(texels.c10), f01 = number(texels.c01),
              f11 = number(texels.c11);
  const float by_x = ((1.0f - p.at.y) * (f10 - f00) + p.at.y * (f11 - f01)) * static_cast<float>(size.x);
  const float by_y = ((1.0f - p.at.x) * (f01 - f00) + p.at.x * (f11 - f10)) * static_cast<float>(size.y);
  const UvTransform& m = bitmap->to_uv;
  return {m.a * by_x + m.d * by_y, m.b * by_x + m.e * by_y};
}

C3f mean_color(const Texture& texture) {
  if (const auto* color = std::get_if<C3f>(&texture)) return *color;
  if (const auto* checkerboard = std::get_if<Checkerboard>(&texture))
    return (checkerboard->color0 + checkerboard->color1) * 0.5f;
  const auto mean = [](const Bitmap& bitmap) { return finished(bitmap, bitmap.image->mean()); };
  if (const auto* bitmap = std::get_if<Bitmap>(&texture)) return mean(*bitmap);
  if (const auto* colors = std::get_if<MeshColors>(&texture))
    return colors->values ? finished(*colors, colors->values->mean) : C3f(0.0f);
  C3f sum(0.0f);
  float count = 0.0f;
  for (const Bitmap& tile : std::get<Udim>(texture).tiles)
    if (tile.image) {
      sum += mean(tile);
      count += 1.0f;
    }
  return count > 0.0f ? sum / count : sum;
}

float aspect_of(const Texture& texture) {
  const auto* bitmap = std::get_if<Bitmap>(&texture);
  return bitmap ? static_cast<float>(bitmap->image->width()) / static_cast<float>(bitmap->image->height())
                : 1.0f;
}

float mean_number(const Texture& texture) { return grey(mean_color(texture)); }

Texture scaled(Texture texture, const TexelScale& scale) {
  if (auto* color = std::get_if<C3f>(&texture)) {
    *color = adjusted(scale, *color);
  } else if (auto* checkerboard = std::get_if<Checkerboard>(&texture)) {
    checkerboard->color0 = adjusted(scale, checkerboard->color0);
    checkerboard->color1 = adjusted(scale, checkerboard->color1);
  } else if (auto* bitmap = std::get_if<Bitmap>(&texture)) {
    bitmap->scale = combined(bitmap->scale, scale);
  } else if (auto* colors = std::get_if<MeshColors>(&texture)) {
    colors->scale = combined(colors->scale, scale);
  } else {
    for (Bitmap& tile : std::get<Udim>(texture).tiles) tile.scale = combined(tile.scale, scale);
  }
  return texture;
}

Texture in_primaries(Texture texture, const ColorMatrix& primaries) {
  if (auto* color = std::get_if<C3f>(&texture)) {
    *color = primaries(*color);
  } else if (auto* checkerboard = std::get_if<Checkerboard>(&texture)) {
    checkerboard->color0 = primaries(checkerboard->color0);
    checkerboard->color1 = primaries(checkerboard->color1);
  } else if (auto* bitmap = std::get_if<Bitmap>(&texture)) {
    bitmap->primaries = primaries;
  } else if (auto* colors = std::get_if<MeshColors>(&texture)) {
    colors->primaries = primaries;
  } else {
    for (Bitmap& tile : std::get<Udim>(texture).tiles) tile.primaries = primaries;
  }
  return texture;
}

}  // namespace twopass
