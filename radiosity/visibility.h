// How much of one patch another sees past the obstacles between them.
#pragma once

#include "radiosity/patch.h"
#include "render/scene/ray_caster.h"

namespace twopass {

/// The fraction of the power exchanged between two patches that is not intercepted, in [0, 1]: Sum G V / Sum G
/// over stratified pairs of points (R12), G the kernel cos cos / r^2. 0 if no pair faces each other. Powers of
/// four are stratified best. `key` seeds the pairs; `rays` is increased by the number of rays cast. There is no
/// early end when a few pairs agree: it would lose what is visible through a gap (1.8 % of the light on the
/// walls of a room lit past the edge of a slab, when four of sixteen pairs were believed).
double visible_fraction(const RayCaster& caster, const Patch& a, const Patch& b, std::uint32_t key,
                        std::uint32_t pairs, std::uint64_t& rays);

}  // namespace twopass
