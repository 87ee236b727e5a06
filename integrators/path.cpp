#include "integrators/path.h"

#include "integrators/trace.h"

namespace twopass {

void PathTracer::trace(std::span<PathSample> samples, RayCounts& counts) const {
  trace_bundles(scene_, limits_, samples, counts, [](Walk& walk) {
    if (!is_specular(walk.bsdf())) walk.sample_lights();
    return walk.leave();
  });
}

}  // namespace twopass
