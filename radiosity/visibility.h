// How much of one patch another sees past the obstacles between them.
#pragma once

#include "radiosity/patch.h"
#include "render/core/sampler.h"
#include "render/scene/ray_caster.h"

namespace twopass {

/// Sum G V / Sum G over pairs of points (R12), G the kernel cos cos / r^2.
class VisiblePart {
 public:
  /// Pairs that do not face each other do not count; `rays` is increased for the others.
  void add(const RayCaster& caster, const ElementPoint& x, const ElementPoint& y, std::uint64_t& rays);
  /// In [0, 1]; 0 if no pair counts.
  [[nodiscard]] double fraction() const { return kernel_ > 0.0 ? visible_ / kernel_ : 0.0; }

 private:
  double kernel_ = 0.0, visible_ = 0.0;
};

/// The fraction of the power exchanged between two surfaces (with `sample`, like Patch) that is not
/// intercepted, in [0, 1]: (R12) over stratified pairs of points. 0 if no pair faces each other. Powers of four
/// are stratified best. `key` seeds the pairs; `rays` is increased by the number of rays cast. There is no
/// early end when a few pairs agree: it would lose what is visible through a gap (1.8 % of the light on the
/// walls of a room lit past the edge of a slab, when four of sixteen pairs were believed).
template <class Surface>
double visible_fraction(const RayCaster& caster, const Surface& a, const Surface& b, std::uint32_t key,
                        std::uint32_t pairs, std::uint64_t& rays) {
  VisiblePart part;
  for (std::uint32_t k = 0; k < pairs; ++k) {
    Sampler sampler(key, 0, k);
    const ElementPoint x = a.sample(sampler.next_2d());
    part.add(caster, x, b.sample(sampler.next_2d()), rays);
  }
  return part.fraction();
}

}  // namespace twopass
