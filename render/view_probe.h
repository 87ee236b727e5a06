// A look at a picture with few paths, before anything is prepared for it: what pass one could save there.
#pragma once

#include <cstdint>
#include <optional>

#include "render/plan.h"
#include "render/scene/camera.h"
#include "render/scene/scene.h"

namespace twopass {

/// What few samples of a picture say.
struct ViewProbe {
  double variance = 0.0;  ///< of a path's radiance, relative to its surroundings in the picture as in relMSE
  double rays = 0.0;      ///< of a path, of all kinds
  /// The same of paths that end where a solution would be read, as if it were black: what pass one leaves to be
  /// found.
  double variance_without = 0.0, rays_without = 0.0;

  /// How many times fewer rays two passes need for the same error, pass one not counted: what the solution
  /// brings is taken to keep a quarter of its variance, that of gathering it.
  [[nodiscard]] double gain() const;
  /// How many paths are as good as one sample of two passes that looks most of the solution's light up: of its
  /// variance a twentieth is left.
  [[nodiscard]] double paths_of_a_sample() const;
  /// The relative error of a picture by two passes with so many samples a pixel, likewise.
  [[nodiscard]] double error_of(double samples) const;
};

/// 2048 pairs of paths, spread over 8x8 parts of the picture. Deterministic. `caustics_known`: pass one brings
/// them, too.
ViewProbe probe_view(const Scene& scene, const Camera& camera, const PixelWindow& window,
                     const PathLimits& limits, std::uint32_t seed, bool caustics_known = false);

/// The gain below which pass one is not worth its own time.
inline constexpr double least_gain = 1.15;

/// Takes the radiosity pass of `two_pass` out of the plan where the view gains too little by it, or where the
/// picture is so short that it would cost more than it saves. `picture_rays`: that two passes would take,
/// about; 0: not known. Where a solution is there already (`has_solution`), it costs nothing. What was seen of
/// the view; none where nobody had to look.
std::optional<ViewProbe> fit_to_view(Plan& plan, IntegratorKind integrator, const Scene& scene,
                                     const Camera& camera, const PixelWindow& window, const PathLimits& limits,
                                     std::uint32_t seed, double picture_rays = 0.0, bool has_solution = false);

}  // namespace twopass
