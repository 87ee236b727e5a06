// Pictures to textures' texels: a file or encoded bytes in memory, whatever OpenEXR or OpenImageIO can read.
#pragma once

#include <filesystem>
#include <limits>
#include <memory>
#include <span>

#include "render/image/texel_decoder.h"
#include "render/image/texture_image.h"

namespace twopass {

struct ReadTexture {
  std::shared_ptr<const TextureImage> image;  ///< never null
  std::size_t not_finite = 0;                 ///< stored samples that were NaN or infinite: they read as 0
};

/// Reads the picture. 8 bits stay 8 bits, half floats half; all else becomes float. What would take more than
/// `most_bytes` of memory is read tile by tile when it is looked at instead, and so are pictures in tiles of
/// more than a million texels. Throws Error when the file is missing, broken, or of no size.
ReadTexture read_texture(const std::filesystem::path& path, const TexelOptions& options,
                         std::size_t most_bytes = std::numeric_limits<std::size_t>::max());
/// The same of an encoded picture in memory (PNG, JPEG or WebP); `where` names it in errors.
ReadTexture read_texture(std::span<const std::byte> encoded, const TexelOptions& options,
                         std::string_view where);

}  // namespace twopass
