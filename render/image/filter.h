// Reconstruction filters for filter importance sampling: the position of a sample inside the footprint of one
// pixel is drawn from the kernel, so every sample belongs to exactly one pixel and pixels need no locks.
#pragma once

#include <memory>
#include <span>

#include "render/core/names.h"
#include "render/core/types.h"

namespace twopass {

class SignedKernel;

enum class FilterKind { box, tent, gaussian, mitchell, catmullrom, lanczos };

/// A separable kernel f(x) f(y) centred on the pixel; lengths in pixels.
struct Filter {
  FilterKind kind = FilterKind::gaussian;
  float radius = 2.0f;  ///< half the width of the support; a Gaussian is cut off at four standard deviations
  float stddev = 0.5f;  ///< of the Gaussian before it is cut off; the other kinds do not use it
  float b = 0.0f, c = 0.5f;  ///< of Mitchell and Netravali's cubics; the other kinds do not use them
  std::shared_ptr<const SignedKernel> table{};  ///< of kinds with negative lobes
};

/// The kernels with the parameters of Mitsuba's plugins. Throw Error unless the length is positive and finite.
Filter box_filter(float radius = 0.5f);
Filter tent_filter(float radius = 1.0f);
Filter gaussian_filter(float stddev = 0.5f);
/// Cubic splines of radius 2 (Mitchell and Netravali 1988, equation 8). Throws Error unless B and C lie in
/// [-10, 10].
Filter mitchell_filter(float b = 1.0f / 3.0f, float c = 1.0f / 3.0f);
/// The same with B = 0, C = 1/2: it interpolates.
Filter catmullrom_filter();
/// sinc(x) sinc(x / lobes), sinc(x) = sin(pi x) / (pi x), of radius `lobes`. Throws Error unless there are 1
/// to 16.
Filter lanczos_filter(int lobes = 3);

/// The names of the kinds, for the command line and scene files.
std::span<const Named<FilterKind>> filter_names();
/// The filter called `name` with default parameters. Throws Error at `where`, listing the names.
Filter filter_of_name(std::string_view name, std::string_view where);

struct FilterSample {
  V2f offset;           ///< from the pixel's centre, in pixels
  float weight = 1.0f;  ///< normalised kernel over density, 1 on average; always 1 without negative lobes
};

/// Draws an offset with the density filter_pdf. REQUIRES: u in [0,1)^2.
FilterSample sample_filter(const Filter& filter, const V2f& u);
/// Density of sample_filter per square pixel at `offset`; its integral is 1.
float filter_pdf(const Filter& filter, const V2f& offset);
/// The kernel itself, not normalised, as Mitsuba defines it: box 1; tent (1 - |x|/r); Gaussian
/// exp(-x^2/(2 s^2)) minus its value at the cut-off; the others as above; each the product over x and y, zero
/// outside the support.
float filter_value(const Filter& filter, const V2f& offset);

}  // namespace twopass
