// How much of one patch another sees past the obstacles between them.
#pragma once

#include "radiosity/patch.h"
#include "render/core/sampler.h"
#include "render/scene/scene.h"

namespace twopass {

/// The share of light that passes between two points, both clear of their own surfaces, in [0, 1]: 0 or 1 but
/// for masks.
double visible_share(const Scene& scene, const V3f& from, const V3f& to);

inline double visible_share(const RayCaster& caster, const V3f& from, const V3f& to) {
  return caster.occluded(from, to) ? 0.0 : 1.0;
}

/// Sum G V / Sum G over pairs of points (R12), G the kernel cos cos / r^2.
class VisiblePart {
 public:
  /// Pairs that do not face each other do not count; `rays` is increased for the others. `between`: a Scene,
  /// or a RayCaster to which everything is opaque.
  template <class Between>
  void add(const Between& between, const ElementPoint& x, const ElementPoint& y, std::uint64_t& rays) {
    const double g = kernel(x, y);
    if (!(g > 0.0)) return;
    kernel_ += g;
    ++rays;
    visible_ += g * visible_share(between, x.ray_position(), y.ray_position());
  }
  /// In [0, 1]; 0 if no pair counts.
  [[nodiscard]] double fraction() const { return kernel_ > 0.0 ? visible_ / kernel_ : 0.0; }

 private:
  static double kernel(const ElementPoint& x, const ElementPoint& y);  // 0 where they do not face each other
  double kernel_ = 0.0, visible_ = 0.0;
};

/// The fraction of the power exchanged between two surfaces (with `sample`, like Patch) that is not
/// intercepted, in [0, 1]: (R12) over stratified pairs of points. 0 if no pair faces each other. Powers of four
/// are stratified best. `key` seeds the pairs; `rays` is increased by the number of rays cast. There is no
/// early end when a few pairs agree: it would lose what is visible through a gap (1.8 % of the light on the
/// walls of a room lit past the edge of a slab, when four of sixteen pairs were believed).
template <class Between, class Surface>
double visible_fraction(const Between& between, const Surface& a, const Surface& b, std::uint32_t key,
                        std::uint32_t pairs, std::uint64_t& rays) {
  VisiblePart part;
  for (std::uint32_t k = 0; k < pairs; ++k) {
    Sampler sampler(key, 0, k);
    const ElementPoint x = a.sample(sampler.next_2d());
    part.add(between, x, b.sample(sampler.next_2d()), rays);
  }
  return part.fraction();
}

}  // namespace twopass
