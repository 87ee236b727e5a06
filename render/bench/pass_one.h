// The radiosity pass alone: solvers and kinds of form factors on the same scene.
#pragma once

#include <string>
#include <vector>

#include "radiosity/options.h"
#include "render/bench/reference.h"
#include "render/stopwatch.h"

namespace twopass {

struct PassOneResult {
  std::string scene, solver, form_factors;
  RadiosityStats stats;
  Elapsed time;
  std::size_t memory_bytes = 0;  ///< most that the process held; 0: unknown
  /// Of the bare solution as the camera sees it, smooth-shaded; the reference's own error taken off.
  double relmse = 0.0;
  C3d energy_ratio{1.0, 1.0, 1.0};
};

/// Solves the scene and looks at the solution. Throws Error, where the method cannot do it, too. REQUIRES: the
/// plan of the integrator `radiosity` has a radiosity pass.
PassOneResult measure_pass_one(const BenchSubject& subject, const RadiosityOptions& options,
                               const BenchReference& reference);

}  // namespace twopass
