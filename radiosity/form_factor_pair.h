// Power exchange between two polygons at any distance: chooses the cheapest of the exact methods. No
// visibility.
#pragma once

#include "radiosity/polygon.h"

namespace twopass {

/// A_a F_ab = A_b F_ba between the fronts of two polygons, without visibility, in units of area; the form
/// factor from a to b is this over polygon_area(a). The result is the same bit for bit when a and b change
/// places and scales with the square of the size. Its relative error is at most `relative_accuracy` at every
/// distance, touching polygons included (measured down to 1e-9); only where polygons that nearly touch also lie
/// nearly in one plane does the rounding error, 1e-15 of their size squared, remain in sight. 0 for
/// back-facing, coplanar or degenerate polygons; never negative. REQUIRES: finite coordinates.
double exchange_exact(const Polygon& a, const Polygon& b, double relative_accuracy = 1e-4);

/// The estimate of A_receiver F_receiver,source by one point: the receiver's area times point_form_factor at
/// its centroid. Not symmetric; its error is of the order (receiver's radius / distance)^2 and unbounded where
/// they touch.
double exchange_point(const Polygon& receiver, const Polygon& source);

}  // namespace twopass
