#include "integrators/radiosity_view.h"

#include "integrators/look_up.h"
#include "integrators/walk.h"

namespace twopass {

Seen RadiosityView::radiance(const Ray& ray, Sampler& sampler, RayCounts& counts) const {
  Seen seen;
  Walk walk(scene_, limits_, ray, sampler, counts);
  while (walk.arrive(seen)) {
    if (!is_specular(walk.bsdf())) {
      if (solution_)
        seen.radiance +=
            walk.throughput() * reflected_radiance(walk.bsdf(), solution_->smooth_irradiance(walk.point()));
      break;
    }
    if (!walk.leave()) break;
  }
  return seen;
}

}  // namespace twopass
