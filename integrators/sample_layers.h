// What a camera ray sees, sorted by the way that the light took and by the lights that it came from, and the
// first surface in it (I15). The integrators fill it in only for samples that bring one.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "radiosity/grouped_light.h"
#include "render/scene/light_groups.h"
#include "render/scene/ray.h"

namespace twopass {

/// The classes of light, by what the first surface of a path does with it. `direct`: it came there straight
/// from a light.
enum class LightClass : std::uint8_t {
  emission,    ///< emitted by the first surface itself
  background,  ///< there is no surface
  diffuse_direct,
  diffuse_indirect,
  specular_direct,  ///< by glossy lobes and mirrors
  specular_indirect,
  transmission_direct,  ///< from behind the surface, whatever the lobe
  transmission_indirect
};
inline constexpr std::size_t light_class_count = 8;

/// How the first surface sends on what arrives from one direction.
struct FirstScatter {
  C3f diffuse{0.0f};  ///< share of its diffuse lobes, in [0, 1]
  bool transmitted = false;
};

/// The first surface that a camera ray meets, holes aside.
struct FirstSurface {
  bool is_there = false;
  SurfacePoint point;
  float distance = 0.0f;     ///< along the ray
  C3f albedo{0.0f};          ///< about what it returns of white light, in [0, 1]
  C3f diffuse_albedo{0.0f};  ///< of that, what a radiosity solution can hold
};

/// Room for the layers of one sample.
struct SampleLayers {
  std::array<C3f, light_class_count> light;  ///< W/(m2 sr), by LightClass; their sum is Seen::radiance
  FirstSurface first{};
  /// Indirect light was looked up at the first surface that is no mirror or glass, not gathered.
  bool looked_up = false;
  /// It was gathered: read from a solution where the next ray met a surface that is no mirror or glass.
  bool gathered = false;
  /// The same light by light group; empty: not asked for.
  std::span<C3f> groups{};
  const LightGroups* light_groups = nullptr;  ///< set where `groups` is
  const GroupedLight* cached = nullptr;       ///< set where `groups` is and the integrator reads a solution
  FirstScatter scatter{};                     ///< of the direction in which the path left its first surface

  /// Forgets what was seen.
  void restart() {
    light.fill(C3f(0.0f));  // Imath leaves a colour of {} as it is
    first.is_there = looked_up = gathered = false;
    std::fill(groups.begin(), groups.end(), C3f(0.0f));
  }
  /// Adds light of the light number `number` (Lights).
  void add(LightClass kind, const C3f& radiance, std::uint32_t number) {
    light[static_cast<std::size_t>(kind)] += radiance;
    add_to_group(radiance, number);
  }
  /// Adds light that the first surface sends on.
  void add_scattered(const C3f& radiance, const FirstScatter& by, bool is_direct, std::uint32_t number) {
    split(radiance, by, is_direct);
    add_to_group(radiance, number);
  }
  /// Adds light of many lights at once, that was looked up at `point`, which is the first surface or not.
  void add_looked_up(const C3f& direct, const C3f& indirect, const FirstScatter& by, bool is_first,
                     const SurfacePoint& point, LookUp look_up) {
    split(direct, by, is_first);
    split(indirect, by, false);
    if (groups.empty()) return;
    if (look_up != LookUp::field) return cached->divide(direct + indirect, point, look_up, groups);
    cached->divide(indirect, point, LookUp::field, groups);
    cached->divide(direct, point, LookUp::lamps, groups);
  }

 private:
  C3f& of(LightClass direct, bool is_direct) {
    return light[static_cast<std::size_t>(direct) + (is_direct ? 0 : 1)];
  }
  void split(const C3f& radiance, const FirstScatter& by, bool is_direct) {
    if (by.transmitted) {
      of(LightClass::transmission_direct, is_direct) += radiance;
      return;
    }
    const C3f diffuse = radiance * by.diffuse;
    of(LightClass::diffuse_direct, is_direct) += diffuse;
    of(LightClass::specular_direct, is_direct) += radiance - diffuse;
  }
  void add_to_group(const C3f& radiance, std::uint32_t number) {
    if (!groups.empty()) groups[light_groups->of(number)] += radiance;
  }
};

}  // namespace twopass
