// Light from infinitely far away, seen by rays that escape.
#pragma once

#include <memory>
#include <optional>
#include <variant>

#include "render/core/color_matrix.h"
#include "render/core/types.h"
#include "render/scene/environment_map.h"
#include "render/scene/sun_sky.h"

namespace twopass {

/// A direction drawn towards the environment.
struct EnvironmentSample {
  V3f direction;  ///< unit, towards the environment
  C3f radiance;   ///< arriving from there, W/(m2 sr)
  float pdf_w;    ///< density in solid angle; 0: nothing to be had
};

/// The environment of a scene: nothing, the same from everywhere, a picture, or sun and sky. Const and
/// thread-safe; cheap to copy.
class Environment {
 public:
  /// The same radiance from all directions; black is no environment.
  explicit Environment(const C3f& constant) : kind_(constant) {}
  Environment() : Environment(C3f(0.0f)) {}
  explicit Environment(std::shared_ptr<const EnvironmentMap> map) : kind_(std::move(map)) {}
  explicit Environment(std::shared_ptr<const SunSky> sky) : kind_(std::move(sky)) {}

  /// Nothing shines from anywhere.
  [[nodiscard]] bool is_black() const { return twopass::is_black(mean_radiance()); }
  /// Radiance that arrives from `direction` (unit, pointing away from the scene), W/(m2 sr).
  [[nodiscard]] C3f radiance(const V3f& direction) const;
  /// REQUIRES: !is_black().
  [[nodiscard]] EnvironmentSample sample(const V2f& u) const;
  /// The density of sample() at `direction`, per steradian.
  [[nodiscard]] float pdf_w(const V3f& direction) const;
  /// Mean radiance over all directions: how often next-event estimation chooses the environment.
  [[nodiscard]] C3f mean_radiance() const;

  /// The same with its colours in other primaries. REQUIRES: they are in none yet.
  [[nodiscard]] Environment in_primaries(const ColorMatrix& primaries) const;

  /// The radiance, where it is the same from all directions.
  [[nodiscard]] std::optional<C3f> constant() const;
  /// "none", "constant", "envmap" or "sunsky".
  [[nodiscard]] const char* kind_name() const;
  /// A hash of everything that radiance() depends on.
  [[nodiscard]] std::uint64_t fingerprint() const;

 private:
  [[nodiscard]] C3f shown(const C3f& color) const { return primaries_ ? (*primaries_)(color) : color; }

  std::variant<C3f, std::shared_ptr<const EnvironmentMap>, std::shared_ptr<const SunSky>> kind_;
  std::optional<ColorMatrix> primaries_;  // of what stands behind a pointer
};

}  // namespace twopass
