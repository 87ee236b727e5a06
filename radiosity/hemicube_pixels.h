// The pixels of a hemicube: directions over a surface, each with its share of the light.
#pragma once

#include <vector>

#include "render/core/types.h"

namespace twopass {

inline constexpr int hemicube_max_resolution = 1024;

/// A direction in the frame of the surface (z is the normal, unit length) and its delta form factor.
struct HemicubePixel {
  V3d direction;
  double weight;
};

/// The pixels of a half cube of 2 x 2 x 1 around the origin, `resolution` x `resolution` of them on the top and
/// half as many on each of the four sides. Weights are the classic delta form factors at the pixels' centres
/// (Cohen and Greenberg 1985), cos cos / (pi r^2) times the pixel's area, scaled to add up to one (R24). Throws
/// Error unless the resolution is even and from 2 to `hemicube_max_resolution`.
std::vector<HemicubePixel> hemicube_pixels(int resolution);

}  // namespace twopass
