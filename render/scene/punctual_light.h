// Lights without extent: they are met by no ray, only by next-event estimation.
#pragma once

#include <variant>

#include "render/core/types.h"

namespace twopass {

/// Shines equally in all directions.
struct PointLight {
  V3f position{0.0f};
  C3f intensity{1.0f};  ///< W/sr
};

using PunctualLight = std::variant<PointLight>;

/// What a punctual light sends to a receiver when nothing is in between.
struct Illumination {
  V3f direction;   ///< unit, from the receiver to the light
  float distance;  ///< to the light; infinite for directional lights
  C3f irradiance;  ///< on a surface that faces the light, W/m2
};

/// The illumination of `light` at `receiver`; black where it does not shine.
Illumination illumination(const PunctualLight& light, const V3f& receiver);

/// Emitted power, W, mean of the channels: how often the light is chosen. `scene_radius` turns the irradiance
/// of directional lights into power.
double power(const PunctualLight& light, double scene_radius);

}  // namespace twopass
