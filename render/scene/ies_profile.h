// The angular distribution of a luminaire's light: a goniophotogram in the C-gamma system (photometric type C).
#pragma once

#include <vector>

#include "render/core/types.h"

namespace twopass {

/// Luminous intensities, candela, on a grid of angles, bilinear between (L22). Const once built; may be shared.
class IesProfile {
 public:
  /// `vertical` are the angles gamma from the luminaire's nadir, degrees, ascending in [0, 180]; beyond the
  /// first and last it is dark. `horizontal` are the half-planes C, degrees, ascending: {0} alone is
  /// rotationally symmetric; up to 90 all quadrants are alike; up to 180 both halves are; up to 360 no
  /// symmetry; from 90 to 270 both halves beside that plane are. `candela` holds all vertical angles of the
  /// first half-plane, then of the next. REQUIRES: candela.size() == vertical.size() * horizontal.size(), all
  /// finite and >= 0.
  IesProfile(std::vector<float> vertical, std::vector<float> horizontal, std::vector<float> candela);

  /// Candela towards `direction` (unit), in the luminaire's frame: +z is the nadir (gamma = 0, where a lamp
  /// on the ceiling shines down), +x the half-plane C = 0; C runs counter-clockwise seen from above.
  [[nodiscard]] float candela(const V3f& direction) const;
  /// Largest value.
  [[nodiscard]] float maximum() const { return maximum_; }
  /// Luminous flux, lm: the integral over all directions of what candela() interpolates.
  [[nodiscard]] double flux() const;

  [[nodiscard]] const std::vector<float>& vertical() const { return vertical_; }
  [[nodiscard]] const std::vector<float>& horizontal() const { return horizontal_; }
  [[nodiscard]] const std::vector<float>& values() const { return candela_; }

 private:
  [[nodiscard]] float at(std::size_t horizontal, std::size_t vertical) const {
    return candela_[horizontal * vertical_.size() + vertical];
  }
  // C folded into the range that the table covers.
  [[nodiscard]] float folded(float degrees) const;

  std::vector<float> vertical_, horizontal_, candela_;
  float maximum_ = 0.0f;
};

}  // namespace twopass
