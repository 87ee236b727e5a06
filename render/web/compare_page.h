// The report of `twopass compare --html`: two pictures, their difference and every measure in one file.
#pragma once

#include <span>
#include <string>

#include "render/image/color.h"
#include "render/image/compare.h"
#include "render/image/exr.h"

namespace twopass {

/// Where a picture came from.
struct PictureSource {
  std::string file;
  ExrMetadata metadata;
};

struct ComparedLayer {
  LayerPair pair;
  Comparison result;
};

/// The page. The first layer comes first and is what the summary speaks of. Values of pixels are embedded as
/// half floats where that loses nothing, else as floats; layers beyond 256 MB of them have tables and pictures
/// only, and the page says so. `display` shows colours to readers without JavaScript. REQUIRES: at least one
/// layer. Throws Error.
std::string compare_page(const PictureSource& test, const PictureSource& reference,
                         std::span<const ComparedLayer> layers, const DisplayTransform& display);

}  // namespace twopass
