// The analytic model of a clear sky's radiance by Hosek and Wilkie, "An Analytic Model for Full Spectral
// Sky-Dome Radiance" (SIGGRAPH 2012), in RGB, and of the sun's seen through the same air (IEEE CG&A 33(3),
// 2013).
#pragma once

#include "render/core/types.h"

namespace twopass {

/// The model's coefficients for one state of the air and one elevation of the sun.
struct HosekSky {
  float shape[3][9];  ///< by channel
  float level[3];     ///< mean radiance that the shape multiplies, W/(m2 sr nm) by the observer's Y, by channel

  /// `turbidity` in [1, 10], `albedo` of the ground in [0, 1], `elevation` of the sun in [0, pi/2].
  HosekSky(float turbidity, const C3f& albedo, float elevation);
  /// Radiance towards the ground from a direction `cos_theta` = z above the horizon that is `gamma` radians
  /// from the sun (L26). REQUIRES: cos_theta >= 0.
  [[nodiscard]] C3f radiance(float cos_theta, float gamma) const;
};

/// Mean radiance of the sun's disc, of the diameter 0.5358 degrees, in the same units (L27).
C3f hosek_sun_radiance(float turbidity, float elevation);

}  // namespace twopass
