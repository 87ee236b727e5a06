#include "integrators/radiosity_view.h"

#include "integrators/look_up.h"
#include "integrators/trace.h"

namespace twopass {

void RadiosityView::trace(std::span<PathSample> samples, RayCounts& counts) const {
  trace_bundles(scene_, limits_, samples, counts, [this](Vertex& vertex) {
    // Mirrors, glass and rough metals are looked through; at black the path ends.
    if (is_black(diffuse_reflectance(vertex.bsdf()))) return Step::scatter;
    if (solution_) {
      const Irradiance irradiance = solution_->smooth_irradiance(vertex.point());
      vertex.add(reflected_radiance(vertex.bsdf(), irradiance), irradiance, LookUp::smooth);
    }
    return Step::end;
  });
}

}  // namespace twopass
