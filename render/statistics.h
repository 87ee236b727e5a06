// The numbers of a run as JSON, for --stats.
#pragma once

#include <filesystem>
#include <optional>

#include "radiosity/options.h"
#include "render/certificate.h"
#include "render/plan.h"
#include "render/render_image.h"
#include "render/stopwatch.h"

namespace twopass {

struct RenderStatistics {
  std::string scene_file;
  std::size_t triangles = 0, emitters = 0;
  std::vector<Skipped> skipped;
  Elapsed load, build, radiosity_time, render, write, total;
  std::optional<RadiosityStats> radiosity;
  bool is_render = true;  ///< false: the radiosity pass alone, all below but threads and seed is not used
  std::string integrator, sampler;
  std::string clamped;  ///< what was clamped, in words; empty: nothing
  std::optional<Certificate> bias;
  bool bias_not_measured = false;  ///< although it was tried
  int width = 0, height = 0;
  std::uint64_t samples = 0;
  RenderOutcome outcome;
  double relative_error = 0.0;        ///< infinity: not estimated
  double relative_error_bound = 0.0;  ///< that it exceeds with a probability of 2 %; infinity: not estimated
  int threads = 0;
  std::uint32_t seed = 0;

  /// Fills in `triangles` and `emitters`.
  void count(const Scene& scene);
};

/// Writes the statistics atomically. Throws Error.
void write_statistics(const std::filesystem::path& path, const RenderStatistics& statistics);

}  // namespace twopass
