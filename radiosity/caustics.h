// Light that emitters throw onto diffuse surfaces over specular ones: shot from the emitters, because small
// lights are rarely found from the other end.
#pragma once

#include "radiosity/elements.h"
#include "render/scene/scene.h"

namespace twopass {

/// Irradiance by element, W/m2, from emitters (not the sky) over at least one specular surface. `paths`
/// particles are shot from all emitters in proportion to their power; `rays` is increased. The same bits on any
/// number of threads.
std::vector<C3d> caustic_irradiance(const Scene& scene, const ElementMesh& mesh, std::size_t paths,
                                    std::uint32_t seed, std::uint64_t& rays);

}  // namespace twopass
