#include "integrators/radiosity_view.h"

#include "integrators/look_up.h"
#include "integrators/trace.h"

namespace twopass {

void RadiosityView::trace(std::span<PathSample> samples, RayCounts& counts) const {
  trace_bundles(scene_, limits_, samples, counts, [this](Walk& walk) {
    if (is_specular(walk.bsdf())) return walk.leave();
    if (solution_) walk.add(reflected_radiance(walk.bsdf(), solution_->smooth_irradiance(walk.point())));
    return false;
  });
}

}  // namespace twopass
