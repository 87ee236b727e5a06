// Texels that are read tile by tile when they are looked at, through OpenImageIO's cache, whose memory is
// bounded.
#pragma once

#include <atomic>
#include <filesystem>
#include <vector>

#include "render/image/oiio_module.h"
#include "render/image/texel_decoder.h"
#include "render/image/texture_image.h"

namespace twopass {

/// The most memory that the tiles of all pictures may take together, in MB. Each thread holds 128 more.
void limit_tile_memory(double megabytes);

class TiledLevels {
 public:
  /// Opens the file. Levels that it lacks are made of the others when they are looked at, from values that are
  /// linear already. Throws Error.
  TiledLevels(const std::filesystem::path& path, const TexelDecoder& decoder, bool as_half);
  TiledLevels(const TiledLevels&) = delete;
  TiledLevels& operator=(const TiledLevels&) = delete;

  [[nodiscard]] const std::vector<V2i>& sizes() const { return sizes_; }
  /// As TextureImage's. Thread-safe.
  [[nodiscard]] C3f texel(int level, int x, int y) const;
  [[nodiscard]] TexelPatch patch(int level, const V2i& x, const V2i& y) const;
  /// Of the file's name, size and time, not of its texels, which nobody reads for that.
  [[nodiscard]] std::uint64_t content_hash() const { return content_hash_; }
  [[nodiscard]] std::uint64_t unreadable() const { return unreadable_; }
  /// Stored values read so far that were NaN or infinite: they read as 0.
  [[nodiscard]] std::uint64_t not_finite() const;

 private:
  struct Reader;
  const void* pixel(int level, int x, int y) const;

  Reader* reader_;  // belongs to the process: OpenImageIO may read a file again at any time
  TwopassTiledPicture picture_{};
  bool as_half_;
  std::uint32_t number_;  // of this, among all
  std::vector<V2i> sizes_;
  std::uint64_t content_hash_ = 0;
  mutable std::atomic<std::uint64_t> unreadable_{0};
};

}  // namespace twopass
