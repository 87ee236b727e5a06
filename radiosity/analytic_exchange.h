// The methods `exact` and `point`: form factors of all pairs of elements, each analytic times the visible
// fraction.
#pragma once

#include "radiosity/balance.h"
#include "radiosity/elements.h"
#include "radiosity/options.h"
#include "render/scene/ray_caster.h"

namespace twopass {

/// Beyond this the n^2 pairs no longer fit into a sensible time and memory.
inline constexpr std::size_t analytic_max_elements = 8192;

/// Shadow rays between two elements: 4 to 64, by their part of all exchange, so that errors of large ones,
/// which do not average out, are small. `total_area`: of the scene's elements, to the next power of two.
inline std::uint32_t visibility_pairs(double unoccluded_exchange, double total_area) {
  constexpr double rays = 0x1p21;
  const double scale = std::exp2(std::ceil(std::log2(total_area)));
  return static_cast<std::uint32_t>(std::clamp(rays * unoccluded_exchange / scale, 4.0, 64.0));
}

/// A_a F_ab without obstacles. Exact for flat patches; a spherical patch is replaced by its flat triangle with
/// the area of the true one (an error of the order of (its size / radius)^2), except that two patches of the
/// inside of one sphere exchange A_a A_b / (4 pi R^2) exactly. `method` is exact or point; `point` takes the
/// mean of both ways. REQUIRES: method is `exact` or `point`.
double unoccluded_exchange(const Patch& a, const Patch& b, FormFactorMethod method);

/// The exchange between all elements. Symmetric by construction; the same bits on any number of threads; `rays`
/// is increased. Throws Error for more than `analytic_max_elements`.
ExchangeMatrix analytic_exchange(const ElementMesh& mesh, const RayCaster& caster, FormFactorMethod method,
                                 std::uint32_t seed, std::uint64_t& rays);

}  // namespace twopass
