#include "integrators/radiosity_view.h"

#include "integrators/look_up.h"
#include "integrators/trace.h"

namespace twopass {

void RadiosityView::trace(std::span<PathSample> samples, RayCounts& counts) const {
  trace_bundles(scene_, limits_, samples, counts, [this](Walk& walk) {
    // Mirrors, glass and rough metals are looked through; at black the path ends.
    if (is_black(diffuse_reflectance(walk.bsdf()))) return walk.leave();
    if (solution_) walk.add(reflected_radiance(walk.bsdf(), solution_->smooth_irradiance(walk.point())));
    return false;
  });
}

}  // namespace twopass
