// Adaptive substructuring: more elements where the radiosity changes.
#pragma once

#include <cstdint>
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

/// What paths that a picture is made of say of an element (integrators, I20), as parts of the picture.
struct ElementError {
  double carried = 0.0;  ///< what it has from the element, as the solution says
  double error = 0.0;    ///< of that, what is too much
  double squares = 0.0;  ///< of the single estimates of `error`
  std::uint32_t reads = 0;

  void add(double carried_by_one, double error_of_one) {
    carried += carried_by_one;
    error += error_of_one;
    squares += error_of_one * error_of_one;
    ++reads;
  }
  void scale(double factor) {
    carried *= factor;
    error *= factor;
    squares *= factor * factor;
  }
};
/// What part of the picture's error each element may be to blame for (R51), as far as that can be told from the
/// noise; 0 for those that cannot be split. REQUIRES: one irradiance and one error an element.
std::vector<double> guilt_of(const ElementMesh& mesh, std::span<const Irradiance> irradiance,
                             std::span<const ElementError> errors);
/// How often to cut each element into four, the guiltiest most often, so that no more guilt is left than
/// `enough` or there are about `most` elements (never more): an element that is cut has half of its guilt left.
std::vector<std::uint8_t> cuts_for(std::span<const double> guilt, double enough, std::size_t most);

}  // namespace twopass
