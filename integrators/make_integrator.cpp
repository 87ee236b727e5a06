#include "integrators/make_integrator.h"

#include "integrators/path.h"
#include "integrators/radiosity_view.h"
#include "integrators/two_pass.h"
#include "integrators/unbiased.h"

namespace twopass {

std::unique_ptr<Integrator> make_integrator(IntegratorKind kind, const Scene& scene, const PassOne& pass_one,
                                            const PathLimits& limits) {
  switch (kind) {
    case IntegratorKind::two_pass:
      return std::make_unique<TwoPass>(scene, pass_one, limits);
    case IntegratorKind::unbiased:
      return std::make_unique<Unbiased>(scene, pass_one, limits);
    case IntegratorKind::radiosity:
      return std::make_unique<RadiosityView>(scene, pass_one.solution, limits);
    case IntegratorKind::path:
      break;
    case IntegratorKind::direct: {
      // Direct light is the path tracer of at most two edges, as in Mitsuba.
      PathLimits two_edges = limits;
      two_edges.max_depth = limits.max_depth < 0 ? 2 : std::min(limits.max_depth, 2);
      return std::make_unique<PathTracer>(scene, two_edges);
    }
  }
  return std::make_unique<PathTracer>(scene, limits);
}

}  // namespace twopass
