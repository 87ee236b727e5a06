// The texels behind a texture: an image and ever smaller copies of it. Knows no coordinates or filters.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "render/image/image.h"

namespace twopass {

/// How a level keeps its values.
enum class TexelFormat : std::uint8_t {
  byte,    ///< a code of 8 bits, which a table of the image turns into the value
  half,    ///< a half float
  single,  ///< a float
};

class TiledLevels;

/// One level of the pyramid; rows from top to bottom, channels interleaved.
struct TexelLevel {
  int width = 0, height = 0;
  TexelFormat format = TexelFormat::single;
  std::vector<std::byte> bytes;
};

/// The four texels around a point, by column and row: c10 is right of c00, c01 below it.
struct TexelPatch {
  C3f c00, c10, c01, c11;
};

/// Linear values, one (grey) or three (R, G, B) a texel. Level 0 holds what was stored; each further one has
/// half the size, rounded down, and holds means over the area of its texels, down to a single one.
class TextureImage {
 public:
  /// The values of R, G, B or Y as they are. Throws Error without those. REQUIRES: at least one pixel, all
  /// finite.
  explicit TextureImage(const Image& image);
  /// `finest` with `channels` (1 or 3) and, for bytes, the values of the 256 codes. Builds the other levels.
  TextureImage(TexelLevel finest, int channels, std::vector<float> values_of_codes);
  /// Levels that are read tile by tile when they are looked at.
  explicit TextureImage(std::unique_ptr<const TiledLevels> tiles);
  ~TextureImage();

  [[nodiscard]] int width() const { return levels_.front().width; }
  [[nodiscard]] int height() const { return levels_.front().height; }
  [[nodiscard]] int level_count() const { return static_cast<int>(levels_.size()); }
  [[nodiscard]] V2i size(int level) const {
    const TexelLevel& l = levels_[static_cast<std::size_t>(level)];
    return {l.width, l.height};
  }
  /// REQUIRES: all in range.
  [[nodiscard]] C3f texel(int level, int x, int y) const;
  /// The texels of the columns x.x, x.y and the rows y.x, y.y. REQUIRES: all in range.
  [[nodiscard]] TexelPatch patch(int level, const V2i& x, const V2i& y) const;

  /// The mean of these four, with the weight `at` of the right and the lower ones. REQUIRES: all in range.
  [[nodiscard]] C3f mix(int level, const V2i& x, const V2i& y, const V2f& at) const;

  /// Mean of all texels of level 0.
  [[nodiscard]] const C3f& mean() const { return mean_; }
  /// A hash of everything that look-ups depend on. The same on every machine.
  [[nodiscard]] std::uint64_t content_hash() const { return content_hash_; }
  /// Whether it is read tile by tile.
  [[nodiscard]] bool is_tiled() const { return tiles_ != nullptr; }
  /// Tiles that could not be read so far: their texels are 0.
  [[nodiscard]] std::uint64_t unreadable_tiles() const;
  /// Stored values of tiles read so far that were NaN or infinite: they read as 0.
  [[nodiscard]] std::uint64_t not_finite() const;
  /// Bytes in memory, without tiles.
  [[nodiscard]] std::size_t memory() const;
  /// Whether all look-ups give the same.
  [[nodiscard]] bool has_same_texels(const TextureImage& other) const;

 private:
  void finish();
  // visit(upper left, upper right, lower left, lower right), four texels of a level that is not tiled.
  template <class Visit>
  auto with_patch(int level, const V2i& x, const V2i& y, const Visit& visit) const;

  std::vector<TexelLevel> levels_;  // without bytes where there are tiles
  std::unique_ptr<const TiledLevels> tiles_;
  int channels_ = 3;
  std::vector<float> values_of_codes_;  // 256, or none
  C3f mean_{0.0f};
  std::uint64_t content_hash_ = 0;
};

}  // namespace twopass
