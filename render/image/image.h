// A rectangle of pixels in memory: named float channels, interleaved. Knows no file format and no display.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "render/core/types.h"

namespace twopass {

/// Pixels with named channels as in OpenEXR: "R", "albedo.G", "Z". The unnamed layer R, G, B (, A) is the
/// picture itself: scene-linear Rec.709, premultiplied by alpha, unless a function says otherwise.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::string> channels;
  std::vector<float> pixels;  ///< interleaved by channel, rows from top to bottom, left to right

  Image() = default;
  /// All zeros. REQUIRES: sizes not negative.
  Image(int width_, int height_, std::vector<std::string> channels_)
      : width(width_),
        height(height_),
        channels(std::move(channels_)),
        pixels(pixel_count() * channels.size()) {}

  [[nodiscard]] std::size_t pixel_count() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  /// Where channel `c` of a pixel stands in `pixels`. REQUIRES: 0 <= x < width, 0 <= y < height, c a channel.
  [[nodiscard]] std::size_t index(int x, int y, int c) const {
    assert(x >= 0 && x < width && y >= 0 && y < height && c >= 0 && c < static_cast<int>(channels.size()));
    return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
               channels.size() +
           static_cast<std::size_t>(c);
  }
  float& at(int x, int y, int c) { return pixels[index(x, y, c)]; }
  [[nodiscard]] float at(int x, int y, int c) const { return pixels[index(x, y, c)]; }

  /// The number of the channel called `name`, or -1.
  [[nodiscard]] int channel(std::string_view name) const;
  /// The channels that make the picture: R, G, B, or three times Y for a picture of luminance alone.
  /// Throws Error when it has neither; `where` names the picture in the message.
  [[nodiscard]] std::array<int, 3> rgb_channels(std::string_view where = "picture") const;
  /// The picture's colour at a pixel. Looks the channels up each time: for loops take rgb_pixels.
  [[nodiscard]] C3f rgb(int x, int y) const;
};

/// The picture's colours alone, row by row. Throws Error like Image::rgb_channels.
std::vector<C3f> rgb_pixels(const Image& image, std::string_view where = "picture");

/// Relative luminance Y of linear Rec.709 (ITU-R BT.709, D65).
inline float luminance(const C3f& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

}  // namespace twopass
