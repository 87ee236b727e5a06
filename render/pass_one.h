// Pass one of a picture: what its integrator reads, made as the plan says.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "integrators/pass_one.h"
#include "radiosity/caustic_map.h"
#include "radiosity/guide.h"
#include "radiosity/indirect_field.h"
#include "radiosity/solution.h"
#include "render/certificate.h"
#include "render/plan.h"
#include "render/sample_plan.h"
#include "render/stopwatch.h"
#include "render/view_probe.h"

namespace twopass {

/// The results of pass one, and what each took. All are null where the plan skips the pass, and where it was left out.
struct PreparedPassOne {
  std::unique_ptr<const Solution> solution;  // on the heap: field and guide point into it
  std::unique_ptr<const IndirectField> field;
  std::unique_ptr<const Guide> guide;
  std::unique_ptr<const CausticMap> caustics;
  bool gathers_twice = false;
  std::string left_out;  ///< why there is no solution, where the plan has one
  Elapsed solution_time, field_time, guide_time, caustics_time;

  [[nodiscard]] PassOne view() const {
    return {solution.get(), field.get(), guide.get(), caustics.get(), gathers_twice};
  }
  [[nodiscard]] Elapsed time() const { return solution_time + field_time + guide_time + caustics_time; }
};

/// Which pass one to run. REQUIRES: the scene outlives what is prepared.
struct PassOneJob {
  const Scene& scene;
  const Plan& plan;
  IntegratorKind integrator;
  RadiosityOptions radiosity;           ///< with the seed of all that is random here
  std::optional<Solution> solved = {};  ///< used instead of solving
  double picture_rays = 0.0;            ///< that the picture is worth (PictureGoal); 0: not known
};
/// The guide has larger cells where its rays would be more than 15 % of what the picture is worth.
PreparedPassOne prepare_pass_one(PassOneJob job);
/// The rays of a picture that is rendered until `sampling` is met, as far as they can be foretold; 0: they
/// cannot.
double rays_of(const SamplingGoal& sampling, const PixelWindow& window, int threads);

/// How far off a picture's mean may be, and what may be done to keep to that.
struct BiasGoal {
  double most = 0.005;   ///< relative
  double rays = 0.0;     ///< about as many for each of the certificates that judge, pilots aside
  double seconds = 0.0;  ///< that all of pass one may take; 0: as long as it does
  bool may_solve_again = true;
};
/// As prepare_pass_one; then measures the bias of the picture that two passes would make (I13), with samples of
/// its own, and where that is certainly larger than it may be takes the first of these steps that is left, and
/// measures again: four times as many elements where they matter most; no look-ups, and gathering over one more
/// surface; paths, without pass one. `say` is told of each step. REQUIRES: the integrator is two_pass.
PreparedPassOne prepare_within_bias(PassOneJob job, const Camera& camera, const PixelWindow& window,
                                    const PathLimits& limits, const BiasGoal& goal,
                                    const std::function<void(const std::string&)>& say);
/// The goal of a picture that is rendered until `sampling` is met: a sixth of the noise asked for, between .1 %
/// and .5 %; a fortieth of the picture's rays, as far as they can be foretold.
BiasGoal bias_goal(const SamplingGoal& sampling, const PixelWindow& window, int threads);

/// What pass one is to suit. 0: not known, nothing is asked for.
struct PictureGoal {
  double rays = 0.0;            ///< that the picture is worth, of all kinds
  double cpu_seconds = 0.0;     ///< that it may take
  double relative_error = 0.0;  ///< that it may have, or will have
};
/// The goal of a picture that is rendered until `sampling` is met. It is worth the rays that paths would take
/// to be as good without pass one, and may take that long, as far as a look at the view can foretell that, or
/// as long as is said.
PictureGoal picture_goal(const SamplingGoal& sampling, const PixelWindow& window, int threads,
                         const std::optional<ViewProbe>& probe);
/// The options of pass one for a picture, over what the user asks for: elements in inverse proportion to its
/// error, and fewer where pass one would take more than 15 % of its time (by its usual pace, and not fewer than
/// 2048 or one for eight triangles).
RadiosityOptions radiosity_options(IntegratorKind integrator, const PathLimits& limits, const Camera& camera,
                                   const PixelWindow& window, RadiosityOptions asked,
                                   const PictureGoal& goal = {});

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
/// None where certify() has none, or finds the truth not above 0.
std::optional<Certificate> certify_picture(const CertifiedPicture& picture);

}  // namespace twopass
