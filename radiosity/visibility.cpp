#include "radiosity/visibility.h"

#include "render/core/sampler.h"

namespace twopass {

namespace {

// Sums over pairs of points.
struct Sum {
  double kernel = 0.0, visible = 0.0;

  void add(const RayCaster& caster, const Patch& a, const Patch& b, Sampler sampler, std::uint64_t& rays) {
    const ElementPoint x = a.sample(sampler.next_2d()), y = b.sample(sampler.next_2d());
    const V3d d = y.position - x.position;
    const double cos_x = x.normal.dot(d), cos_y = -y.normal.dot(d), d2 = d.dot(d);
    if (!(cos_x > 0.0) || !(cos_y > 0.0)) return;
    const double g = cos_x * cos_y / (d2 * d2);
    kernel += g;
    ++rays;
    if (!caster.occluded(x.ray_position(), y.ray_position())) visible += g;
  }
  [[nodiscard]] double fraction() const { return kernel > 0.0 ? visible / kernel : 0.0; }
};

}  // namespace

double visible_fraction(const RayCaster& caster, const Patch& a, const Patch& b, std::uint32_t key,
                        std::uint32_t pairs, std::uint64_t& rays) {
  Sum sum;
  for (std::uint32_t k = 0; k < pairs; ++k) sum.add(caster, a, b, Sampler(key, 0, k), rays);
  return sum.fraction();
}

}  // namespace twopass
