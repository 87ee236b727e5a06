// Power exchange between whole shapes without visibility, where closed forms are known.
#pragma once

#include <optional>

#include "radiosity/shape_rays.h"

namespace twopass {

/// A_a F_ab = A_b F_ba between the fronts of two shapes (perhaps the same one) that do not hide anything from
/// each other or from themselves: every front on a line counts, also behind others. Meshes by pairs of
/// triangles to `relative_accuracy`; nothing for pairs without a closed form. They exist for spheres with
///   - a triangle that has the whole sphere in front of it: R^2 times its solid angle from the centre, since
///   the
///     irradiance from a sphere in full view is that of a point, cos R^2 / d^2;
///   - what lies inside of a sphere seen from inside: all that it sends out arrives;
/// for disks on one axis, and for what the inside of a cylinder sees of itself (Howell, A Catalog of Radiation
/// Heat Transfer Configuration Factors, C-41 and C-78).
std::optional<double> unoccluded_exchange(const Scene& scene, const ShapeFronts& fronts, std::uint32_t a,
                                          std::uint32_t b, double relative_accuracy);

}  // namespace twopass
