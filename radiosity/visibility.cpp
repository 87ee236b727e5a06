#include "radiosity/visibility.h"

namespace twopass {

double visible_share(const Scene& scene, const V3f& from, const V3f& to) {
  if (scene.has_see_through()) return static_cast<double>(scene.transmittance({from, to}));
  return visible_share(scene.caster(), from, to);
}

double VisiblePart::kernel(const ElementPoint& x, const ElementPoint& y) {
  const V3d d = y.position - x.position;
  const double cos_x = x.normal.dot(d), cos_y = -y.normal.dot(d), d2 = d.dot(d);
  if (!(cos_x > 0.0) || !(cos_y > 0.0)) return 0.0;
  return cos_x * cos_y / (d2 * d2);
}

}  // namespace twopass
