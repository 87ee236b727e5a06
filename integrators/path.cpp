#include "integrators/path.h"

#include "integrators/walk.h"

namespace twopass {

Seen PathTracer::radiance(const Ray& ray, Sampler& sampler, RayCounts& counts) const {
  Seen seen;
  Walk walk(scene_, limits_, ray, sampler, counts);
  while (walk.arrive(seen)) {
    if (!is_specular(walk.bsdf())) seen.radiance += walk.direct_light();
    if (!walk.leave()) break;
  }
  return seen;
}

}  // namespace twopass
