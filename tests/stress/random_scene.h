// Scenes of any kind from a seed: rooms and open places with boxes, balls, needles and dust, mirrors and glass,
// lit by lamps, bulbs and skies, of any size and anywhere.
#pragma once

#include <string>

#include "tests/stress/picture.h"

namespace twopass::stress {

/// The same scene for the same seed on every machine, with a camera.
SceneDescription random_scene(std::uint32_t seed);

/// How far `twopass` and `path` agree on the mean of a picture.
struct Agreement {
  Picture path, two_pass;
  double difference = 0.0;  ///< of the means, over that of `path`; 0 where both are black
  double noise = 0.0;       ///< its standard error
  std::string fault;        ///< of either picture; empty: none
  int tries = 0;            ///< until it held, at most 3
  [[nodiscard]] bool holds() const;
  /// What a solution of few elements may be off by.
  static constexpr double bias = 0.06;
  /// Radiance that a darker picture counts as: of lamps, which have 1 to 10, hardly anything.
  static constexpr double darkest = 1e-6;
};
/// Renders both. What does not hold at few samples is tried again with many and more elements, since rare
/// bright paths are no disagreement, and then as `twopass render` does by default, which judges the solution by
/// its bias (integrators, I17), where few elements are too wrong.
Agreement compare_integrators(std::uint32_t seed);

}  // namespace twopass::stress
