// Power exchange between two polygons by the double contour integral: exact where they touch. No visibility.
#pragma once

#include "radiosity/polygon.h"

namespace twopass {

/// A_a F_ab = A_b F_ba between the fronts of two polygons, without visibility, in units of area: equation (R3).
/// Each polygon is first clipped by the plane of the other. Edges that touch, cross or run side by side have
/// closed forms ((R5), (R6)); the others one numerical integral (R7), as long as `relative_accuracy` asks for.
/// What rounding leaves is about 1e-15 times the product of the polygons' perimeters: nothing to polygons side
/// by side, too much to those far apart or nearly in one plane; exchange_exact (form_factor_pair.h) chooses. 0
/// for back-facing, coplanar or degenerate polygons; never negative. REQUIRES: finite coordinates.
double contour_exchange(const Polygon& a, const Polygon& b, double relative_accuracy = 1e-12);

/// The same for two polygons that are already clipped by each other's plane. REQUIRES: both in front of the
/// other.
double contour_exchange_clipped(const Polygon& a, const Polygon& b, double relative_accuracy);

}  // namespace twopass
