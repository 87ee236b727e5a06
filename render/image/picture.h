// Pictures in files, by extension: .exr scene-linear; .png, .jpg, .tif display-referred.
#pragma once

#include <filesystem>

#include "render/image/color.h"
#include "render/image/exr.h"
#include "render/image/image.h"

namespace twopass {

/// For use before rendering: throws Error when write_picture does not know the extension (listing those it
/// knows) or nothing can be written there.
void check_picture_path(const std::filesystem::path& path);

/// Whether write_picture puts the pixels through the display transform for this extension.
bool is_display_referred(const std::filesystem::path& path);

/// Writes scene-linear pixels in the format of the extension. Display-referred formats hold R, G, B alone, seen
/// through `display`, which knows what space they are in; nullptr stands for DisplayTransform({}), Rec.709.
/// `options` serve OpenEXR, and their data_offset the dither of the others. Atomic; throws Error.
void write_picture(const std::filesystem::path& path, const Image& scene_linear,
                   const DisplayTransform* display, const ExrOptions& options = {});

/// Reads any picture to linear Rec.709 values, premultiplied: OpenEXR converted where colorInteropID names
/// other primaries (its layer `variance`, which cannot be, is then called other_variance), else as it is;
/// pictures stored as integers are decoded from sRGB. With `metadata`, also what read_exr tells of an OpenEXR
/// file. Throws Error.
Image read_picture(const std::filesystem::path& path, ExrMetadata* metadata = nullptr);

}  // namespace twopass
