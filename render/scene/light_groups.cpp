#include "render/scene/light_groups.h"

#include <algorithm>
#include <cctype>

namespace twopass {

namespace {

std::string layer_name(const std::string& name) {
  std::string result;
  for (const char c : name) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_';
    result += is_plain ? c : '_';
  }
  return result.empty() ? "default" : result;
}

}  // namespace

LightGroups::LightGroups(const SceneDescription& scene)
    : group_(scene.shapes.size() + scene.punctual_lights.size() + 1, no_index) {
  std::uint32_t light = 0;
  for (const Shape& shape : scene.shapes) {
    if (is_emitter(shape)) add(light, shape.light_group.value_or(shape.name));
    ++light;
  }
  for (std::size_t i = 0; i < scene.punctual_lights.size(); ++i)
    add(light++, i < scene.punctual_light_groups.size() ? scene.punctual_light_groups[i] : "");
  if (!scene.environment.is_black()) add(light, scene.environment_light_group);
}

void LightGroups::add(std::uint32_t light, const std::string& name) {
  const std::string group = layer_name(name);
  const auto known = std::find(names_.begin(), names_.end(), group);
  group_[light] = static_cast<std::uint32_t>(known - names_.begin());
  if (known == names_.end()) names_.push_back(group);
}

SceneDescription LightGroups::lit_by(const SceneDescription& scene, std::uint32_t group) const {
  SceneDescription lit = scene;
  std::uint32_t light = 0;
  for (Shape& shape : lit.shapes)
    if (group_[light++] != group) {
      shape.radiance = {C3f(0.0f), C3f(0.0f)};
      shape.radiance_texture = nullptr;
    }
  lit.punctual_lights.clear();
  for (const PunctualLight& punctual : scene.punctual_lights)
    if (group_[light++] == group) lit.punctual_lights.push_back(punctual);
  if (group_[light] != group) lit.environment = Environment();
  return lit;
}

}  // namespace twopass
