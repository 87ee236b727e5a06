// Pictures in other formats than OpenEXR: PNG, JPEG and TIFF out, whatever OpenImageIO knows in.
// OpenImageIO takes 0.2 s to load, so it lives in a module of its own (twopass_oiio.so) that is loaded on first
// use.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "render/image/image.h"

namespace twopass {

struct RasterImage {
  Image image;                    ///< values as stored, integers scaled to [0,1]; alpha not multiplied in
  bool display_referred = false;  ///< stored as integers: by convention encoded with the sRGB curve
};

/// Writes the picture's R, G, B, display-referred in [0,1], in the format of the extension: .png, .jpg and
/// .jpeg with 8 bits a channel, .tif and .tiff with 16. Dithered: a value between two steps becomes the upper
/// one as often as it is close to it, which its mean over pixels keeps; values on a step stay there. `corner`
/// is the place of the image in the full frame, which decides on the pattern. Same pixels, same bytes. Atomic.
/// Throws Error on any failure, a missing module included.
void write_raster(const std::filesystem::path& path, const Image& image, const V2i& corner = {0, 0});

/// The bytes of the picture as a PNG file of the nearest values, not dithered. Throws Error.
std::vector<std::byte> encode_png(const Image& image);

/// Reads any picture that OpenImageIO understands. Throws Error when it does not, or the file is missing or
/// broken.
RasterImage read_raster(const std::filesystem::path& path);

}  // namespace twopass
