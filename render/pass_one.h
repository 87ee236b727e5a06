// Pass one of a picture: what its integrator reads, made as the plan says.
#pragma once

#include <memory>
#include <optional>

#include "integrators/pass_one.h"
#include "radiosity/guide.h"
#include "radiosity/indirect_field.h"
#include "radiosity/solution.h"
#include "render/certificate.h"
#include "render/plan.h"
#include "render/stopwatch.h"

namespace twopass {

/// The results of pass one, and what each took. All are null where the plan skips the pass.
struct PreparedPassOne {
  std::unique_ptr<const Solution> solution;  // on the heap: field and guide point into it
  std::unique_ptr<const IndirectField> field;
  std::unique_ptr<const Guide> guide;
  Elapsed solution_time, field_time, guide_time;

  [[nodiscard]] PassOne view() const { return {solution.get(), field.get(), guide.get()}; }
  [[nodiscard]] Elapsed time() const { return solution_time + field_time + guide_time; }
};

/// Which pass one to run. REQUIRES: the scene outlives what is prepared.
struct PassOneJob {
  const Scene& scene;
  const Plan& plan;
  IntegratorKind integrator;
  RadiosityOptions radiosity;           ///< with the seed of all that is random here
  std::optional<Solution> solved = {};  ///< used instead of solving
};
PreparedPassOne prepare_pass_one(PassOneJob job);

/// The options of pass one for a picture, over what the user asks for. `cpu_seconds`: all that the picture may
/// take; pass one then has fewer elements where it would take more than 15 % of that (by its usual pace, and
/// not fewer than 2048 or one for eight triangles); 0: as long as it takes.
RadiosityOptions radiosity_options(IntegratorKind integrator, const PathLimits& limits, const Camera& camera,
                                   const PixelWindow& window, RadiosityOptions asked, double cpu_seconds = 0.0);

/// Of the rays of a picture, about as many more go into its certificate.
inline constexpr double certificate_share = 0.05;

/// What part of a picture is certified.
struct CertifiedPicture {
  const Scene& scene;
  const PreparedPassOne& pass_one;
  const Integrator& integrator;  ///< that rendered it
  const PathLimits& limits;
  const Camera& camera;
  PixelWindow window;
  std::uint32_t seed;
  RayCounts counts;  ///< of the picture
};
/// Measures the bias of a picture that reads a solution (I13), with about a twentieth of the picture's rays.
std::optional<Certificate> certify_picture(const CertifiedPicture& picture);

}  // namespace twopass
