// Light from infinitely far away, seen by rays that escape.
#pragma once

#include "render/core/types.h"

namespace twopass {

/// A direction drawn towards the environment.
struct EnvironmentSample {
  V3f direction;  ///< unit, towards the environment
  C3f radiance;   ///< arriving from there, W/(m2 sr)
  float pdf_w;    ///< density in solid angle; 0: nothing to be had
};

/// The environment of a scene. Const and thread-safe.
class Environment {
 public:
  /// The same radiance from all directions; black is no environment.
  explicit Environment(const C3f& constant = C3f(0.0f)) : constant_(constant) {}

  /// Nothing shines from anywhere.
  [[nodiscard]] bool is_black() const { return twopass::is_black(constant_); }
  /// Radiance that arrives from `direction` (unit, pointing away from the scene), W/(m2 sr).
  [[nodiscard]] C3f radiance(const V3f& direction) const;
  /// REQUIRES: !is_black().
  [[nodiscard]] EnvironmentSample sample(const V2f& u) const;
  /// The density of sample() at `direction`, per steradian.
  [[nodiscard]] float pdf_w(const V3f& direction) const;
  /// Mean radiance over all directions: how often next-event estimation chooses the environment.
  [[nodiscard]] C3f mean_radiance() const { return constant_; }

 private:
  C3f constant_;
};

}  // namespace twopass
