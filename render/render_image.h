// Pixels into rays, rays into a film: the loop over passes, tiles and pixels.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "integrators/integrator.h"
#include "render/image/filter.h"
#include "render/layers.h"
#include "render/sample_plan.h"

namespace twopass {

/// How far a render is.
struct RenderProgress {
  double fraction;           ///< that is done of the goal that is nearest
  int pass;                  ///< from 1
  double samples_per_pixel;  ///< taken so far, on average
  double error;              ///< the film's relative error, as far as it is known; else infinity
  double rays_per_second;    ///< of all kinds
};

/// What a render has cost, beside time.
struct RenderCosts {
  RayCounts counts{};
  std::uint64_t non_finite_samples = 0;
};

/// Where a render stands, for it to be taken up again.
struct RenderState {
  PlanState plan{};
  RenderCosts costs{};
};

struct RenderJob {
  const Integrator& integrator;
  const Camera& camera;
  Filter filter;
  SamplingGoal goal;
  std::uint32_t seed = 0;
  SamplerKind sampler = SamplerKind::sobol;
  RayCone cone{};  ///< of each sample's ray: how textures are filtered
  std::function<void(const RenderProgress&)> report_progress{};  ///< called by any thread
  V2i corner{0, 0};  ///< the film's upper left pixel in the camera's picture, of which it may be a part
  std::uint32_t first_sample =
      0;  ///< of each pixel: other numbers of the same seed's are other parts of a render
  std::uint32_t all_samples = 0;  ///< of a pixel, in all parts: for stratified sampling; 0: those of the goal
  const RenderState* resumed = nullptr;  ///< where the film's render stood; null where the film is empty
  /// Asked by any thread now and then. When it is true, the render pauses between two tiles and calls at_pause,
  /// while nobody touches the film.
  std::function<bool()> wants_pause{};
  std::function<void(const RenderState&)> at_pause{};
  std::function<void(const V2i& corner, const V2i& size)> tile_done{};  ///< of the film; by the tile's thread
  const Layers* layers = nullptr;  ///< what the film's layers hold; null where it has none
};

/// One sample of a picture: what to look at again with the same seed.
struct SamplePlace {
  V2i pixel;             ///< of the camera's picture
  std::uint32_t sample;  ///< of the pixel
};

struct RenderOutcome {
  RayCounts counts;  ///< with those of the resumed render, as all here
  std::uint64_t non_finite_samples = 0;
  /// The first of them by row, column and sample, of those taken by this run; the same on any number of
  /// threads.
  std::optional<SamplePlace> first_non_finite{};
  std::string stop_reason;            ///< "samples", "time", "noise" or "interrupted"
  double pixels_stopped_early = 0.0;  ///< share of the pixels with fewer samples than the mean of all
  PlanState plan{};                   ///< where it stopped
};

/// Renders into the film. Every sample is a pure function of (seed, pixel of the camera's picture, sample
/// index), so the film does not depend on the number of threads, and a part of a picture is the same as in the
/// whole, and a render that stops and is resumed with the same goal the same as one that does not. Stops early,
/// with whole samples, when the user interrupts.
RenderOutcome render_image(const RenderJob& job, Film& film);

}  // namespace twopass
