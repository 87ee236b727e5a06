// Stochastic Jacobi radiosity: the balance (R11) solved by shooting power along random rays. Form factors
// appear as probabilities only; none is computed or stored, so memory grows with the elements alone.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "radiosity/elements.h"
#include "render/scene/scene.h"

namespace twopass {

struct StochasticOptions {
  /// Rays shot an element, on average, before the error is looked at. The last of the light, too little for a
  /// ray of full power, takes some more (see README).
  double rays_per_element = 64.0;
  /// Stops when the light not shot yet can change the mean radiosity by at most a tenth of this.
  double relative_error = 0.01;
  /// Goes on until `StochasticResult::error_bound` is at most `relative_error`.
  bool until_relative_error = false;
  /// Most reflections after the direct irradiance; -1: all of them.
  int max_reflections = -1;
  std::uint32_t seed = 0;
  /// Rays stratified over each element and its hemisphere (randomised quasi-Monte Carlo). False: independent
  /// random numbers, for which (R29) holds as it stands, to measure the gain.
  bool stratified = true;
};

/// Power by channel in whole units of the run.
using PowerUnits = std::array<std::int64_t, 3>;

/// Where the power went that the elements reflected of their direct irradiance. Exact: see `balances`.
struct PowerAudit {
  PowerUnits emitted{};   ///< the first reflection of the direct irradiance
  PowerUnits absorbed{};  ///< by elements, black and emitting surfaces, and on the way over specular ones
  PowerUnits escaped{};   ///< into the sky
  PowerUnits unshot{};    ///< not under way any more when the run stopped
  C3d watts_per_unit{0.0};
  /// emitted = absorbed + escaped + unshot, to the last bit.
  [[nodiscard]] bool balances() const;
};

struct StochasticResult {
  std::vector<C3f> irradiance;  ///< by element, W/m2: from other elements, direct irradiance excluded
  std::size_t iterations = 0;
  std::uint64_t shots = 0;  ///< rays that carried power from an element
  std::uint64_t rays = 0;   ///< all rays cast: `shots`, their specular continuations, redrawn starts
  /// Unshot power over all power reflected, of the worst channel; 0 when `max_reflections` is the end.
  double residual = 0.0;
  /// Expected Sum A |noise| over Sum A B of the worst channel (R30).
  double noise = 0.0;
  /// `noise` and what the unshot power can still add: residual / (1 - largest reflectance).
  double error_bound = 0.0;
  PowerAudit audit;
};

/// What a run holds in memory for each element, direct irradiance and result included.
inline constexpr std::size_t stochastic_bytes_per_element = 60;

/// Solves by (R28). `direct_irradiance`, W/m2: >= 0, one an element. Reflectances are clamped to
/// `largest_reflectance`. The same bits on any number of threads. Throws Interrupted when the user stops it.
StochasticResult solve_stochastic(const Scene& scene, const ElementMesh& mesh,
                                  std::span<const C3f> direct_irradiance, const StochasticOptions& options);

}  // namespace twopass
