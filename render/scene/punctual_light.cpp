#include "render/scene/punctual_light.h"

namespace twopass {

namespace {

Illumination illumination_of(const PointLight& light, const V3f& receiver) {
  const V3f to_light = light.position - receiver;
  const float distance2 = to_light.dot(to_light);
  if (!(distance2 > 0.0f)) return {V3f(0.0f, 0.0f, 1.0f), 0.0f, C3f(0.0f)};
  const float distance = std::sqrt(distance2);
  return {to_light * (1.0f / distance), distance, light.intensity * (1.0f / distance2)};
}

double power_of(const PointLight& light, double) { return 4.0 * pi * mean_component(light.intensity); }

}  // namespace

Illumination illumination(const PunctualLight& light, const V3f& receiver) {
  return std::visit([&](const auto& kind) { return illumination_of(kind, receiver); }, light);
}

double power(const PunctualLight& light, double scene_radius) {
  return std::visit([&](const auto& kind) { return power_of(kind, scene_radius); }, light);
}

}  // namespace twopass
