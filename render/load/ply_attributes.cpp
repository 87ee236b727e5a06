#include "render/load/ply_attributes.h"

#include <algorithm>

#include "render/image/srgb.h"

namespace twopass {
namespace {

bool is_among(const std::vector<std::string_view>& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

/// The colour without a prefix.
std::optional<PlyAttribute> plain_color(const PlyElement& element, const std::string& prefix) {
  for (const std::array<const char*, 3>& names :
       {std::array{"r", "g", "b"}, std::array{"red", "green", "blue"}}) {
    std::array<std::size_t, 3> property;
    std::ranges::transform(names, property.begin(), [&](const char* name) { return element.find(name); });
    if (std::ranges::max(property) < element.properties.size()) return PlyAttribute{prefix + "color", property};
  }
  return std::nullopt;
}

}  // namespace

std::vector<PlyAttribute> ply_attributes(const PlyElement& element, const std::string& prefix,
                                         const std::vector<std::string_view>& reserved) {
  std::vector<PlyAttribute> attributes;
  const auto color = plain_color(element, prefix);
  if (color) attributes.push_back(*color);
  const std::vector<std::string_view> color_names{"r", "g", "b", "a", "red", "green", "blue", "alpha"};
  const auto is_free = [&](std::size_t i) {
    const PlyProperty& p = element.properties[i];
    return !p.is_list && !is_among(reserved, p.name) && !(color && is_among(color_names, p.name));
  };
  const std::size_t count = element.properties.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_free(i)) continue;
    const std::string& name = element.properties[i].name;
    const std::string stem =
        name.size() > 2 && name[name.size() - 2] == '_' ? name.substr(0, name.size() - 1) : "";
    const PlyAttribute number{prefix + name, {i, i, i}};
    bool is_run = false;
    for (const std::string_view ends : {"xyz", "rgb", "012", "123"}) {
      const auto is_next = [&](std::size_t k) {
        return i + k < count && is_free(i + k) && element.properties[i + k].name == stem + ends[k];
      };
      if (stem.empty() || !is_next(0) || !is_next(1) || !is_next(2)) continue;
      const std::string color_ending = ends == "rgb" ? "_color" : "";
      attributes.push_back({prefix + stem.substr(0, stem.size() - 1) + color_ending, {i, i + 1, i + 2}});
      i += 2;
      is_run = true;
      break;
    }
    if (!is_run) attributes.push_back(number);
  }
  return attributes;
}

float ply_attribute_value(double number, PlyType type) {
  constexpr double largest[] = {127.0, 255.0, 32767.0, 65535.0, 2147483647.0, 4294967295.0};
  if (!is_integer(type)) return static_cast<float>(number);
  return srgb_decode(static_cast<float>(std::max(0.0, number) / largest[static_cast<std::size_t>(type)]));
}

}  // namespace twopass
