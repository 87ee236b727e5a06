// Reconstruction filters for filter importance sampling: the position of a sample inside the footprint of one
// pixel is drawn from the kernel, so every sample belongs to exactly one pixel and pixels need no locks.
#pragma once

#include <span>

#include "render/core/names.h"
#include "render/core/types.h"

namespace twopass {

enum class FilterKind { box, tent, gaussian };

/// A separable kernel f(x) f(y) centred on the pixel; lengths in pixels.
struct Filter {
  FilterKind kind = FilterKind::gaussian;
  float radius = 2.0f;  ///< half the width of the support; a Gaussian is cut off at four standard deviations
  float stddev = 0.5f;  ///< of the Gaussian before it is cut off; the other kinds do not use it
};

/// The three kernels with the parameters of Mitsuba's `box`, `tent` and `gaussian`.
/// Throw Error unless the length is positive and finite.
Filter box_filter(float radius = 0.5f);
Filter tent_filter(float radius = 1.0f);
Filter gaussian_filter(float stddev = 0.5f);

/// The names of the kinds, for the command line and scene files.
std::span<const Named<FilterKind>> filter_names();
/// The filter called `name` with default parameters. Throws Error at `where`, listing the names.
Filter filter_of_name(std::string_view name, std::string_view where);

struct FilterSample {
  V2f offset;           ///< from the pixel's centre, in pixels
  float weight = 1.0f;  ///< normalised kernel over density; 1 as long as no kernel has negative lobes
};

/// Draws an offset with the density filter_pdf. REQUIRES: u in [0,1)^2.
FilterSample sample_filter(const Filter& filter, const V2f& u);
/// Density of sample_filter per square pixel at `offset`; its integral is 1.
float filter_pdf(const Filter& filter, const V2f& offset);
/// The kernel itself, not normalised, as Mitsuba defines it: box 1; tent (1 - |x|/r); Gaussian
/// exp(-x^2/(2 s^2)) minus its value at the cut-off; each the product over x and y, zero outside the support.
float filter_value(const Filter& filter, const V2f& offset);

}  // namespace twopass
