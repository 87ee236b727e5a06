// Pixels into rays, rays into a film: the loop over passes, tiles and pixels.
#pragma once

#include <functional>
#include <string>

#include "integrators/integrator.h"
#include "render/image/film.h"
#include "render/image/filter.h"

namespace twopass {

/// When to stop. The first goal that is met ends the render; zero means no such goal.
struct SamplingGoal {
  int samples_per_pixel = 0;
  double seconds = 0.0;
  double relative_error = 0.0;  ///< of Film::relative_error()
};

/// Where a render without a goal of samples stops at last.
inline constexpr int most_samples_per_pixel = 1 << 16;

struct RenderJob {
  const Integrator& integrator;
  const Camera& camera;
  Filter filter;
  SamplingGoal goal;
  std::uint32_t seed = 0;
  std::function<void(double)> report_progress;  ///< called by any thread with the fraction that is done
};

struct RenderOutcome {
  RayCounts counts;
  std::uint64_t non_finite_samples = 0;
  std::string stop_reason;  ///< "samples", "time", "noise" or "interrupted"
};

/// Renders into the film. Every sample is a pure function of (seed, pixel, sample index), so the film does not
/// depend on the number of threads. Stops early, with whole samples, when the user interrupts.
RenderOutcome render_image(const RenderJob& job, Film& film);

}  // namespace twopass
