// What of a picture the elements are.
#pragma once

#include <span>
#include <vector>

#include "radiosity/elements.h"
#include "render/scene/scene.h"

namespace twopass {

/// What camera rays see first that is not purely specular, mirrors and glass followed. `rays` is increased by
/// the number of rays cast.
std::vector<SurfacePoint> seen_points(const Scene& scene, std::span<const Ray> view, std::uint32_t seed,
                                      std::uint64_t& rays);
/// Of each element, the part of the points that lie on it; nothing without points.
std::vector<double> parts_of(const ElementMesh& mesh, std::span<const SurfacePoint> points);

/// By element, parts of a picture, of which all is 1.
struct ViewParts {
  std::vector<double> first;       ///< that show the element, mirrors and glass followed
  std::vector<double> over_coats;  ///< that show what else than diffusely reflects it, times how much it does
};
/// From camera rays; nothing without any. `rays` is increased by the number of rays cast.
ViewParts parts_seen(const Scene& scene, const ElementMesh& mesh, std::span<const Ray> view, std::uint32_t seed,
                     std::uint64_t& rays);

}  // namespace twopass
