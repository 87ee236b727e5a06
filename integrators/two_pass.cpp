#include "integrators/two_pass.h"

#include "integrators/look_up.h"
#include "integrators/walk.h"

namespace twopass {

namespace {

// Gather rays shorter than this many element sizes come from so near that one constant irradiance cannot stand
// for what the vertex sees of the element: evaluate instead.
constexpr float contact_elements = 2.0f;

}  // namespace

bool TwoPass::resolves(const SurfacePoint& point, float distance) const {
  if (!solution_) return false;
  const float size = solution_->element_size(point);
  return size > 0.0f && distance >= contact_elements * size;
}

Seen TwoPass::radiance(const Ray& ray, Sampler& sampler, RayCounts& counts) const {
  Seen seen;
  Walk walk(scene_, limits_, ray, sampler, counts);
  bool gathering = false;  // the path has left a diffuse vertex: the next one may be looked up
  while (walk.arrive(seen)) {
    if (!is_specular(walk.bsdf())) {
      if (gathering && resolves(walk.point(), walk.distance())) {
        seen.radiance += walk.carried(reflected_radiance(walk.bsdf(), solution_->irradiance(walk.point())));
        break;
      }
      seen.radiance += walk.direct_light();
      gathering = true;
    }
    if (!walk.leave()) break;
  }
  return seen;
}

}  // namespace twopass
