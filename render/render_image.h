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
  std::function<void(double)> report_progress{};  ///< called by any thread with the fraction that is done
  V2i corner{0, 0};  ///< the film's upper left pixel in the camera's picture, of which it may be a part
};

struct RenderOutcome {
  RayCounts counts;
  std::uint64_t non_finite_samples = 0;
  std::string stop_reason;            ///< "samples", "time", "noise" or "interrupted"
  double pixels_stopped_early = 0.0;  ///< share of the pixels with fewer samples than the mean of all
};

/// Renders into the film. Every sample is a pure function of (seed, pixel of the camera's picture, sample
/// index), so the film does not depend on the number of threads, and a part of a picture is the same as in the
/// whole. Stops early, with whole samples, when the user interrupts.
RenderOutcome render_image(const RenderJob& job, Film& film);

}  // namespace twopass
