// What all OpenEXR files of this program have in common: the header of a picture, and our words for the
// library's errors. Only for the files that know OpenEXR.
#pragma once

#include <exception>
#include <filesystem>
#include <string>

#include <OpenEXR/ImfHeader.h>

#include "render/core/error.h"
#include "render/image/exr.h"

namespace twopass {

/// The header of scan lines without channels: windows, colour tag, metadata.
Imf::Header picture_header(int width, int height, const ExrOptions& options, bool has_color = true);
/// The metadata and the place in the full frame that a header holds.
ExrOptions options_of(const Imf::Header& header);
/// Throws Error unless the path is a regular file that begins like OpenEXR.
void check_is_exr(const std::filesystem::path& path);

/// Says what OpenEXR says of a file in our words.
template <class Action>
auto in_our_words(const std::filesystem::path& path, const Action& action) {
  try {
    return action();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(path.string(), std::string("it cannot be read: ") + e.what(), "write the file again");
  }
}

}  // namespace twopass
