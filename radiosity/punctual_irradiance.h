// Irradiance of the elements straight from lights without extent: points, spots, projectors, directions.
#pragma once

#include "radiosity/element_response.h"
#include "render/scene/scene.h"

namespace twopass {

/// Up to so many punctual lights each is asked at every point of an element; of more, samples are drawn.
inline constexpr std::size_t most_punctual_lights_asked = 64;

/// By element, W/m2: the mean over stratified points of it of what arrives from punctual lights (R38), past
/// obstacles and through masks, weighted as in DirectIrradiance. `rays` is increased. The same bits on any
/// number of threads.
std::vector<C3d> punctual_irradiance(const Scene& scene, const ElementMesh& mesh,
                                     const ElementResponse& response, std::uint32_t seed, std::uint64_t& rays);

}  // namespace twopass
