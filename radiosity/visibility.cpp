#include "radiosity/visibility.h"

namespace twopass {

void VisiblePart::add(const RayCaster& caster, const ElementPoint& x, const ElementPoint& y,
                      std::uint64_t& rays) {
  const V3d d = y.position - x.position;
  const double cos_x = x.normal.dot(d), cos_y = -y.normal.dot(d), d2 = d.dot(d);
  if (!(cos_x > 0.0) || !(cos_y > 0.0)) return;
  const double g = cos_x * cos_y / (d2 * d2);
  kernel_ += g;
  ++rays;
  if (!caster.occluded(x.ray_position(), y.ray_position())) visible_ += g;
}

}  // namespace twopass
