#include "integrators/path.h"

#include "integrators/trace.h"

namespace twopass {

void PathTracer::trace(std::span<PathSample> samples, RayCounts& counts) const {
  trace_bundles(scene_, limits_, samples, counts, [](Vertex& vertex) {
    return is_specular(vertex.bsdf()) ? Step::scatter : Step::light_and_scatter;
  });
}

}  // namespace twopass
