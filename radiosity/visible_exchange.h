// Power exchange between two polygons past other polygons: what stands in the way is cut out exactly.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "radiosity/polygon.h"
#include "radiosity/shaft.h"

namespace twopass {

/// Triangles and convex quadrilaterals, each of which hides what is behind either of its sides.
class Blockers {
 public:
  /// REQUIRES: no degenerate polygons; at most four corners each.
  explicit Blockers(std::vector<Polygon> polygons);

  /// Whether nothing at all reaches between the fronts of two polygons: then all of their exchange is visible.
  [[nodiscard]] bool none_between(const Polygon& a, const Polygon& b) const;

  /// Whether one of the polygons alone comes between every point of a and every point of b: then nothing of b
  /// is visible from a. Sure when true; where several hide b together it is false.
  [[nodiscard]] bool one_hides(const Polygon& a, const Polygon& b) const;

  /// A_a F_ab = A_b F_ba between the fronts of two polygons of at most four corners, past all blockers (R26),
  /// in units of area. `unoccluded` is what they exchange without any. The error is about `accuracy` times
  /// `unoccluded`; pairs with nothing between them come back as they are. Blockers that lie in the plane of a
  /// or b, touch it or share its edges are allowed; a and b may be blockers themselves. Deterministic.
  [[nodiscard]] double visible_exchange(const Polygon& a, const Polygon& b, double unoccluded,
                                        double accuracy) const;

 private:
  friend class PairInSight;
  std::vector<Polygon> polygon_;
  std::vector<V3d> normal_;
  std::vector<Imath::Box3d> bounds_;
  double rounding_ = 0.0;  // the distance that coordinates cannot tell from 0
};

/// The same surface in fewer polygons: neighbours in the list that share an edge, lie in one plane and make up
/// a convex quadrilateral become one. REQUIRES: triangles.
std::vector<Polygon> join_triangles(std::span<const Polygon> triangles);

}  // namespace twopass
