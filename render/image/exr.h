// OpenEXR files: scene-linear pictures with any number of channels. Colour is tagged, never converted.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "render/core/names.h"
#include "render/core/types.h"
#include "render/image/image.h"
#include "render/image/primaries.h"

namespace twopass {

enum class PixelType { half, float_ };

/// How pixels are packed. All but the first five lose digits, of colours at least.
enum class ExrCompression { none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa, dwab };
inline constexpr Named<ExrCompression> exr_compression_names[] = {
    {"none", ExrCompression::none}, {"rle", ExrCompression::rle},   {"zips", ExrCompression::zips},
    {"zip", ExrCompression::zip},   {"piz", ExrCompression::piz},   {"pxr24", ExrCompression::pxr24},
    {"b44", ExrCompression::b44},   {"b44a", ExrCompression::b44a}, {"dwaa", ExrCompression::dwaa},
    {"dwab", ExrCompression::dwab}};

enum class ExrParts {
  single,  ///< all layers in one part, which every program reads
  layer    ///< a part for each layer, called like it; channels keep their full names
};
inline constexpr Named<ExrParts> exr_parts_names[] = {{"single", ExrParts::single}, {"layer", ExrParts::layer}};

/// When the chromaticities of the colour space stand beside its name: `automatic`, unless it is Rec.709, which
/// readers assume.
enum class ExrChromaticities { automatic, always, never };
inline constexpr Named<ExrChromaticities> exr_chromaticities_names[] = {{"auto", ExrChromaticities::automatic},
                                                                        {"always", ExrChromaticities::always},
                                                                        {"never", ExrChromaticities::never}};

/// What colorInteropID says of spaces that have no name in the list.
inline constexpr const char* unknown_space = "unknown";

/// Header attributes in order: name such as "twopass/spp", and text or number.
using ExrMetadata = std::vector<std::pair<std::string, std::variant<std::string, float, int>>>;

struct ExrOptions {
  /// Of colour channels, those called R, G, B, A or `layer.R` ... All others (Z, N.X, ...) are data: always
  /// float.
  PixelType pixel_type = PixelType::half;
  /// Layers whose R, G, B, A are data nevertheless, for example Cryptomatte's.
  std::vector<std::string> float_layers{};
  /// Layers of whole numbers: stored as such. REQUIRES: values from 0 to 2^24.
  std::vector<std::string> integer_layers{};
  ExrMetadata metadata{};
  ExrCompression compression = ExrCompression::zips;
  ExrParts parts = ExrParts::single;
  /// The attribute colorInteropID: one of interop_spaces(), or unknown_space.
  std::string color_space = rec709_id;
  std::optional<Primaries> primaries{};  ///< of an unknown space, if it is known what it is
  ExrChromaticities chromaticities = ExrChromaticities::automatic;
  /// Standard attributes of the camera, see render/scene/camera.h.
  std::optional<M44f> world_to_camera{}, world_to_ndc{};
  /// Where the image lies in the full frame: upper left corner, and the frame's size (default: the image's
  /// own).
  V2i data_offset{0, 0};
  std::optional<V2i> display_size{};
};

/// For use before rendering: throws Error when pictures of these channels cannot be written so: names that
/// repeat or are empty, a compression that loses digits for channels that are data, an unknown colour space.
void check_exr(const std::filesystem::path& path, const std::vector<std::string>& channels,
               const ExrOptions& options);

/// Writes scan lines. Values that are not finite
/// become 0 and those beyond the type's range its end (half: +-65504). Atomic. Throws Error on any failure, and
/// as check_exr.
void write_exr(const std::filesystem::path& path, const Image& image, const ExrOptions& options = {});

/// What the header alone says of the first part.
struct ExrFacts {
  V2i size;                            ///< of the data window
  std::optional<Primaries> primaries;  ///< of its colours, if colorInteropID tells them
};
/// Throws Error as read_exr.
ExrFacts exr_facts(const std::filesystem::path& path);

/// Reads the first part's data window with all channels of all parts: R, G, B, A first, the others by part and
/// name; 0 where a part has no pixels. A name that an earlier part has, too, gets the part's name in front.
/// Deep parts behind the first are left out. Values are as in the file, non-finite ones included. With
/// `metadata`, also the first part's attributes of text, float and int; with `primaries`, those of its colours
/// if colorInteropID tells them. Throws Error when the file is missing, no OpenEXR, incomplete, deep or has
/// subsampled channels.
Image read_exr(const std::filesystem::path& path, ExrMetadata* metadata = nullptr,
               std::optional<Primaries>* primaries = nullptr);

}  // namespace twopass
