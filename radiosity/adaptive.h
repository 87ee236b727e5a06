// Adaptive substructuring: more elements where the radiosity changes.
#pragma once

#include <span>
#include <vector>

#include "radiosity/elements.h"
#include "radiosity/irradiance.h"

namespace twopass {

/// The power that a constant radiosity misplaces on each element (R37): area x albedo x difference between the
/// largest and the smallest irradiance at its corners, in W and of the brightest channel. 0 for clusters, which
/// cannot be split. REQUIRES: one irradiance an element.
std::vector<double> misplaced_power(const ElementMesh& mesh, std::span<const Irradiance> irradiance);

/// Chooses the elements that gain most by being split, at most `most`: their gain is the part of the total
/// power that they misplace, and, where a picture is known of which the elements are the parts `seen` (empty:
/// no picture), those parts times the contrast on them (R44), and in place of the power what it means to the
/// picture (R46), if `importance` says so. None of those that together gain less than
/// `negligible`. Equals are chosen in the order of elements.
std::vector<bool> elements_to_split(const ElementMesh& mesh, std::span<const Irradiance> irradiance,
                                    std::span<const double> seen, std::size_t most, double negligible,
                                    std::span<const double> importance = {});

}  // namespace twopass
