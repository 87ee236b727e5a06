// OpenEXR files: scene-linear pictures with any number of channels. Colour is tagged, never converted.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "render/core/types.h"
#include "render/image/image.h"

namespace twopass {

enum class PixelType { half, float_ };

/// Header attributes in order: name such as "twopass/spp", and text or number.
using ExrMetadata = std::vector<std::pair<std::string, std::variant<std::string, float, int>>>;

struct ExrOptions {
  /// Of colour channels, those called R, G, B, A or `layer.R` ... All others (Z, N.X, ...) are data: always
  /// float.
  PixelType pixel_type = PixelType::half;
  /// Layers whose R, G, B, A are data nevertheless, for example Cryptomatte's.
  std::vector<std::string> float_layers{};
  ExrMetadata metadata{};
  /// Where the image lies in the full frame: upper left corner, and the frame's size (default: the image's
  /// own).
  V2i data_offset{0, 0};
  std::optional<V2i> display_size{};
};

/// Writes one part of scan lines, ZIPS, tagged colorInteropID = lin_rec709_scene. Values that are not finite
/// become 0 and those beyond the type's range its end (half: +-65504). Atomic. Throws Error on any failure, and
/// on channel names that repeat or are empty.
void write_exr(const std::filesystem::path& path, const Image& image, const ExrOptions& options = {});

/// Width and height of the first part's data window, from the header alone. Throws Error as read_exr.
V2i exr_size(const std::filesystem::path& path);

/// Reads the first part's data window with all its channels: R, G, B, A first, the others by name. Values are
/// as in the file, non-finite ones included. With `metadata`, also the attributes of text, float and int.
/// Throws Error when the file is missing, no OpenEXR, incomplete, deep or has subsampled channels.
Image read_exr(const std::filesystem::path& path, ExrMetadata* metadata = nullptr);

}  // namespace twopass
