#include "render/image/image.h"

#include "render/core/error.h"

namespace twopass {

int Image::channel(std::string_view name) const {
  const auto found = std::find(channels.begin(), channels.end(), name);
  return found == channels.end() ? -1 : static_cast<int>(found - channels.begin());
}

std::array<int, 3> Image::rgb_channels(std::string_view where) const {
  const std::array<int, 3> rgb{channel("R"), channel("G"), channel("B")};
  if (rgb[0] >= 0 && rgb[1] >= 0 && rgb[2] >= 0) return rgb;
  const int y = channel("Y");
  if (y >= 0) return {y, y, y};
  throw Error(where, "the picture has neither the channels R, G, B nor Y",
              "save the colour in the unnamed layer of the file");
}

C3f Image::rgb(int x, int y) const {
  const auto [r, g, b] = rgb_channels();
  return {at(x, y, r), at(x, y, g), at(x, y, b)};
}

std::vector<C3f> rgb_pixels(const Image& image, std::string_view where) {
  const auto [r, g, b] = image.rgb_channels(where);
  std::vector<C3f> result;
  result.reserve(image.pixel_count());
  for (std::size_t i = 0; i < image.pixels.size(); i += image.channels.size()) {
    const float* pixel = &image.pixels[i];
    result.emplace_back(pixel[r], pixel[g], pixel[b]);
  }
  return result;
}

}  // namespace twopass
