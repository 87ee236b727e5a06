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

}  // namespace twopass
