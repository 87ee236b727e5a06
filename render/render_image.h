// Pixels into rays, rays into a film: the loop over passes, tiles and pixels.
#pragma once

#include <functional>
#include <string>

#include "integrators/integrator.h"
#include "render/image/filter.h"
#include "render/sample_plan.h"

namespace twopass {

struct RenderJob {
  const Integrator& integrator;
  const Camera& camera;
  Filter filter;
  SamplingGoal goal;
  std::uint32_t seed = 0;
  SamplerKind sampler = SamplerKind::sobol;
  RayCone cone{};  ///< of each sample's ray: how textures are filtered
  std::function<void(double)> report_progress;  ///< called by any thread with the fraction that is done
};

struct RenderOutcome {
  RayCounts counts;
  std::uint64_t non_finite_samples = 0;
  std::string stop_reason;            ///< "samples", "time", "noise" or "interrupted"
  double pixels_stopped_early = 0.0;  ///< share of the pixels with fewer samples than the mean of all
};

/// Renders into the film. Every sample is a pure function of (seed, pixel, sample index), so the film does not
/// depend on the number of threads. Stops early, with whole samples, when the user interrupts.
RenderOutcome render_image(const RenderJob& job, Film& film);

}  // namespace twopass
