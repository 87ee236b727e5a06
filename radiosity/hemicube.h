// The method `hemicube`: what the centroid of each element sees in the pixels of a half cube around it. Kept
// for comparison with the classical literature: it aliases and takes every element for a point.
#pragma once

#include "radiosity/balance.h"
#include "radiosity/elements.h"
#include "render/scene/scene.h"

namespace twopass {

/// The exchange between all elements, from a hemicube at each one's centroid: one ray through the centre of
/// each pixel tells what an item buffer would hold. Both elements' estimates are joined like those of rays, so
/// the matrix is symmetric (R24). Elements only: what pixels show of lamps, black sides, specular surfaces and
/// sky is left out. Each cube is turned about its normal by an angle of its own, a hash of `seed` and the
/// element, so that aliasing differs between neighbours. An element whose centroid lies right under another
/// surface sees nothing; the other elements' estimates of it stand alone. The same bits on any number of
/// threads; `rays` is increased. Throws Error for a resolution that `hemicube_pixels` refuses, and for more
/// than `analytic_max_elements`.
ExchangeMatrix hemicube_exchange(const Scene& scene, const ElementMesh& mesh, int resolution,
                                 std::uint32_t seed, std::uint64_t& rays);

}  // namespace twopass
