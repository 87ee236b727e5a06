// Spectra to the three linear channels of the working space (Rec.709 primaries, D65 white).
#pragma once

#include <vector>

#include "render/core/types.h"

namespace twopass {

/// A spectrum as wavelengths in nanometres, ascending, with a value each; linear between, zero outside.
struct SampledSpectrum {
  std::vector<double> wavelengths, values;
};

/// The reflectance's colour under D65: a constant 1 is exactly (1, 1, 1). Not clamped.
C3d reflectance_of_spectrum(const SampledSpectrum& spectrum);

/// Emitted light seen by the CIE observer, scaled so that a constant 1 has a luminance of 1 (its colour is that
/// of illuminant E, slightly purple under a D65 white). Not clamped.
C3d emission_of_spectrum(const SampledSpectrum& spectrum);

/// emission_of_spectrum of the constant `value`.
C3d emission_of_uniform_spectrum(double value);

/// The CIE 1931 2-degree matching functions at a wavelength in nanometres, by the multi-lobe fit of Wyman,
/// Sloan and Shirley, "Simple Analytic Approximations to the CIE XYZ Color Matching Functions", JCGT 2 (2),
/// 2013; its error is about 1 % of the peaks, less than observers differ.
V3d cie_xyz(double wavelength);

/// XYZ to linear Rec.709.
C3d rec709_of_xyz(const V3d& xyz);

}  // namespace twopass
