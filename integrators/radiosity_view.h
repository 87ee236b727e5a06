// The bare radiosity solution as the camera sees it, smooth-shaded; mirrors and glass are traced.
#pragma once

#include "integrators/integrator.h"
#include "radiosity/solution.h"

namespace twopass {

class RadiosityView final : public Integrator {
 public:
  /// `solution` may be null where the radiosity pass was skipped: then only emission is seen.
  /// REQUIRES: scene and solution outlive the integrator.
  RadiosityView(const Scene& scene, const Solution* solution, const PathLimits& limits)
      : scene_(scene), solution_(solution), limits_(limits) {}
  void trace(std::span<PathSample> samples, RayCounts& counts) const override;

 private:
  const Scene& scene_;
  const Solution* solution_;
  PathLimits limits_;
};

}  // namespace twopass
