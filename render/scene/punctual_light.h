// Lights without extent: they are met by no ray, only by next-event estimation.
#pragma once

#include <memory>
#include <variant>

#include "materials/texture.h"
#include "render/core/types.h"
#include "render/scene/ies_profile.h"

namespace twopass {

/// Where a light stands and how it is turned.
struct LightFrame {
  V3f position{0.0f};
  V3f to_local[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};  ///< local coordinate i of a vector v is v . to_local[i]
  V3f forward{0, 0, 1};  ///< the local +z in the world; as long as the matrix makes it

  [[nodiscard]] V3f local(const V3f& v) const {
    return {v.dot(to_local[0]), v.dot(to_local[1]), v.dot(to_local[2])};
  }
};

/// The frame of a matrix for row vectors. REQUIRES: it can be inverted.
LightFrame light_frame(const M44d& to_world);

/// Shines in all directions: equally, or as a luminaire's photometry says.
struct PointLight {
  V3f position{0.0f};
  C3f intensity{1.0f};  ///< W/sr
  /// When given, `intensity` counts for each of its candela (L22): with (1, 1, 1) irradiances are in lux.
  std::shared_ptr<const IesProfile> profile{};
  LightFrame frame{};  ///< how the profile is turned; its position does not count
};

/// A cone of light around the local +z, as Mitsuba's `spot` (L20).
struct SpotLight {
  LightFrame frame;
  C3f intensity{1.0f};                         ///< W/sr, inside of the beam
  float cutoff_angle = 20.0f * pi_f / 180.0f;  ///< from the axis to darkness, radians, below a right angle
  float beam_width = 15.0f * pi_f / 180.0f;    ///< from the axis to where it begins to fade; <= cutoff_angle
  std::shared_ptr<const Texture> texture{};    ///< factors, projected to fill the cone; may be null
};

/// Light from infinitely far away, from one direction.
struct DirectionalLight {
  V3f direction{0, 0, 1};  ///< in which it travels, unit
  C3f irradiance{1.0f};    ///< on a surface across it, W/m2
};

/// Throws a picture like a slide projector, as Mitsuba's `projector` (L21).
struct Projector {
  LightFrame frame;                        ///< the picture's right is local -x, its top local +y
  std::shared_ptr<const Texture> texture;  ///< never null
  float scale = 1.0f;
  float tan_half_fov = 0.41421356f;  ///< of half the horizontal field of view
};

using PunctualLight = std::variant<PointLight, SpotLight, DirectionalLight, Projector>;

/// The light with its colours in other primaries.
PunctualLight in_primaries(PunctualLight light, const ColorMatrix& primaries);

/// What a punctual light sends to a receiver when nothing is in between.
struct Illumination {
  V3f direction;   ///< unit, from the receiver to the light
  float distance;  ///< to the light; infinite for directional lights
  C3f irradiance;  ///< on a surface that faces the light, W/m2
};

/// The illumination of `light` at `receiver`; black where it does not shine, and at the light itself.
Illumination illumination(const PunctualLight& light, const V3f& receiver);

/// Emitted power, W, mean of the channels: how often the light is chosen. `scene_radius` turns the irradiance
/// of directional lights into power.
double power(const PunctualLight& light, double scene_radius);

/// "point", "spot", "directional" or "projector".
const char* kind_name(const PunctualLight& light);

/// A hash of everything that the light's illumination depends on. The same on every machine.
std::uint64_t fingerprint(const PunctualLight& light);

}  // namespace twopass
