#include "render/image/layers.h"

#include <algorithm>
#include <optional>

namespace twopass {

namespace {

std::string_view group_of(std::string_view channel) {
  const std::size_t dot = channel.rfind('.');
  return dot == std::string_view::npos ? std::string_view() : channel.substr(0, dot);
}

// The channels GROUP.a, GROUP.b, GROUP.c, where the image has them all.
std::optional<std::array<int, 3>> triple(const Image& image, std::string_view group, const char* leaves) {
  std::array<int, 3> found{};
  for (std::size_t i = 0; i < 3; ++i) {
    found[i] = image.channel((group.empty() ? std::string() : std::string(group) + '.') + leaves[i]);
    if (found[i] < 0) return std::nullopt;
  }
  return found;
}

}  // namespace

std::vector<Layer> layers_of(const Image& image) {
  std::vector<Layer> layers;
  std::vector<bool> taken(image.channels.size(), false);
  const auto add = [&](std::string_view name, LayerKind kind, const std::array<int, 3>& channels) {
    layers.push_back({std::string(name), kind, channels});
    for (const int c : channels) taken[static_cast<std::size_t>(c)] = true;
  };
  for (std::size_t i = 0; i < image.channels.size(); ++i) {
    if (taken[i]) continue;
    const std::string& channel = image.channels[i];
    const std::string_view group = group_of(channel);
    const std::string_view leaf = std::string_view(channel).substr(group.empty() ? 0 : group.size() + 1);
    const auto color = triple(image, group, "RGB"), vector = triple(image, group, "XYZ");
    const int number = static_cast<int>(i);
    if (color && (leaf == "R" || leaf == "G" || leaf == "B"))
      add(group, LayerKind::color, *color);
    else if (vector && (leaf == "X" || leaf == "Y" || leaf == "Z"))
      add(group, LayerKind::vector, *vector);
    else if (leaf == "Y" && !color)
      add(group, LayerKind::color, {number, number, number});
    else
      add(channel, LayerKind::scalar, {number, number, number});
  }
  std::stable_partition(layers.begin(), layers.end(), [](const Layer& layer) { return layer.name.empty(); });
  return layers;
}

std::vector<C3f> layer_pixels(const Image& image, const Layer& layer) {
  std::vector<C3f> result;
  result.reserve(image.pixel_count());
  for (std::size_t i = 0; i < image.pixels.size(); i += image.channels.size()) {
    const float* pixel = &image.pixels[i];
    result.emplace_back(pixel[layer.channels[0]], pixel[layer.channels[1]], pixel[layer.channels[2]]);
  }
  return result;
}

}  // namespace twopass
