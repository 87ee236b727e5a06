// Which parts of elements are seen from afar, that is by whom the solution is read.
#pragma once

#include "radiosity/elements.h"
#include "render/scene/scene.h"

namespace twopass {

/// For ElementMesh::weigh(): how often random walks from camera rays come to the sixteenths of each cell over
/// at least `contact_elements` times its size, and one of the places (R48); all 0 where that is less than 32
/// times in all. A walk goes on from each surface in a cosine-distributed direction, through mirrors and glass
/// as light does. `rays` is increased by the number of rays cast: about 128 a cell. The same on any number of
/// threads. REQUIRES: the view is not empty.
std::vector<ElementMesh::Weights> weights_from_afar(const Scene& scene, const ElementMesh& mesh,
                                                    std::span<const Ray> view, std::uint32_t seed,
                                                    std::uint64_t& rays);

/// Rays shorter than this many element sizes come from so near that one irradiance cannot stand for what they
/// see of an element: who gathers does not read it there.
inline constexpr float contact_elements = 2.0f;

}  // namespace twopass
