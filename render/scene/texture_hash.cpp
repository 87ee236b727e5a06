#include "render/scene/texture_hash.h"

namespace twopass {

namespace {

void add_uv_transform(DataHash& hash, const UvTransform& m) {
  for (const float x : {m.a, m.b, m.c, m.d, m.e, m.f}) hash.add(x);
}
void add_scale(DataHash& hash, const std::optional<TexelScale>& scale) {
  hash.add(std::uint64_t{scale.has_value()});
  if (!scale) return;
  hash.add(scale->factor);
  hash.add(scale->offset);
  hash.add(scale->lowest);
  hash.add(scale->highest);
}
void add_primaries(DataHash& hash, const std::optional<ColorMatrix>& primaries) {
  if (!primaries) return;
  for (const C3f& color : primaries->image) hash.add(color);
}
void add_texture_kind(DataHash& hash, const C3f& color) { hash.add(color); }
void add_texture_kind(DataHash& hash, const Checkerboard& checkerboard) {
  hash.add(checkerboard.color0);
  hash.add(checkerboard.color1);
  add_uv_transform(hash, checkerboard.to_uv);
}
void add_texture_kind(DataHash& hash, const Bitmap& bitmap) {
  hash.add(static_cast<std::uint64_t>(bitmap.filter));
  hash.add(static_cast<std::uint64_t>(bitmap.wrap_u) << 32 | static_cast<std::uint64_t>(bitmap.wrap_v));
  add_uv_transform(hash, bitmap.to_uv);
  hash.add(bitmap.image ? bitmap.image->content_hash() : 0);
  add_scale(hash, bitmap.scale);
  add_primaries(hash, bitmap.primaries);
}
void add_texture_kind(DataHash& hash, const MeshColors& colors) {
  add_scale(hash, colors.scale);
  add_primaries(hash, colors.primaries);
  hash.add(std::uint64_t{colors.values ? colors.values->corners.size() : 0});
  if (!colors.values) return;
  for (const std::array<C3f, 3>& triangle : colors.values->corners)
    for (const C3f& color : triangle) hash.add(color);
}
void add_texture_kind(DataHash& hash, const Udim& udim) {
  add_uv_transform(hash, udim.to_uv);
  hash.add(std::uint64_t{udim.tiles.size()});
  for (const Bitmap& tile : udim.tiles) add_texture_kind(hash, tile);
}

}  // namespace

void add_texture(DataHash& hash, const Texture& texture) {
  hash.add(std::uint64_t{texture.index()});
  std::visit([&](const auto& kind) { add_texture_kind(hash, kind); }, texture);
}

}  // namespace twopass
