// Directions towards a convex polygon, uniform in projected solid angle: cosine-weighted without rejection.
#pragma once

#include <array>
#include <span>

#include "render/core/types.h"

namespace twopass {

/// A convex spherical polygon above the plane z = 0. Its outline, seen from above, consists of arcs of ellipses
/// around the origin, and Lambert's sum over the edges is its area there (L5).
class ProjectedPolygon {
 public:
  static constexpr int capacity = 5;

  /// The part above z = 0 of the polygon whose corners lie in these directions (any length). They run such that
  /// the corner products v[i] x v[i + 1] point inwards. REQUIRES: at most four, on one side of a plane through
  /// the origin.
  explicit ProjectedPolygon(std::span<const V3d> corners);

  /// Projected solid angle, in [0, pi]. 0: nothing can be sampled.
  [[nodiscard]] double area() const { return area_; }
  /// A unit direction, of density z / area() in solid angle. REQUIRES: area() > 0.
  [[nodiscard]] V3d sample(const V2f& u) const;

 private:
  [[nodiscard]] int next(int i) const { return i + 1 == n_ ? 0 : i + 1; }
  [[nodiscard]] V3d sample_around_zenith(double u, double v) const;
  [[nodiscard]] V3d sample_beside_zenith(double u, double v) const;

  int n_ = 0;
  bool holds_zenith_ = false;
  std::array<V3d, capacity> corner_;     // unit
  std::array<V3d, capacity> normal_;     // unit, of the plane through corners i and i + 1, inwards
  std::array<double, capacity> part_;    // of the sum over the edges
  std::array<double, capacity> length_;  // of the arc between corners i and i + 1
  double area_ = 0.0;
};

}  // namespace twopass
