#include "materials/rough_plastic.h"

namespace twopass {

std::optional<BsdfSample> RoughPlastic::sample(const V3f& wo, const V2f& u) const {
  const RoughPlasticView view = seen_from(wo);
  if (!(view.coat_probability >= 0.0f)) return std::nullopt;
  V2f rest = u;
  const V3f wi = choose(rest.x, view.coat_probability) ? view.draw_from_coat(rest) : view.draw_from_base(rest);
  return drawn(wi, view.evaluate(wi, coat->transmittance_at(std::max(0.0f, wi.z))));
}

}  // namespace twopass
