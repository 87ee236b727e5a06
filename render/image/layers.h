// The layers of a picture: which channels belong together.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "render/image/image.h"

namespace twopass {

enum class LayerKind {
  color,   ///< R, G, B; or Y alone, three times
  vector,  ///< X, Y, Z
  scalar   ///< one channel
};

/// Channels of an image that are looked at together.
struct Layer {
  std::string name;  ///< what stands before the last dot of its channels, empty for the picture itself; of a
                     ///< scalar the channel's whole name
  LayerKind kind = LayerKind::color;
  std::array<int, 3> channels{};  ///< their numbers in the image; of a scalar three times the same
};

/// The layers: channels are grouped by what stands before their last dot, then R, G, B and X, Y, Z of a group
/// are one layer, and every other channel (A, Z, `layer.A`, ...) is one. The picture itself comes first, the
/// others in the order of their first channels. Names are unique.
std::vector<Layer> layers_of(const Image& image);

/// The values of a layer, row by row.
std::vector<C3f> layer_pixels(const Image& image, const Layer& layer);

}  // namespace twopass
