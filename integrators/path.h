// The ground truth: unidirectional path tracing with next-event estimation. Unbiased; knows nothing of the
// radiosity solution.
#pragma once

#include "integrators/integrator.h"

namespace twopass {

class PathTracer final : public Integrator {
 public:
  /// REQUIRES: the scene outlives the integrator.
  PathTracer(const Scene& scene, const PathLimits& limits) : scene_(scene), limits_(limits) {}
  void trace(std::span<PathSample> samples, RayCounts& counts) const override;

 private:
  const Scene& scene_;
  PathLimits limits_;
};

}  // namespace twopass
