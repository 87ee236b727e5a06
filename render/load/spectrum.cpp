#include "render/load/spectrum.h"

#include <array>

namespace twopass {
namespace {

constexpr double first_wavelength = 360.0, last_wavelength = 830.0;

/// Relative power of CIE standard illuminant D65 (ISO 11664-2) from 360 to 830 nm in steps of 10 nm.
constexpr std::array<double, 48> d65_table = {
    46.6383, 52.0891, 49.9755, 54.6482, 82.7549, 91.486,  93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861,
    115.923, 108.811, 109.354, 107.802, 104.79,  107.689, 104.405, 104.046, 100.0,   96.3342, 95.788,  88.6856,
    90.0062, 89.5991, 87.6987, 83.2886, 83.6992, 80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349,
    61.604,  69.8856, 75.087,  63.5927, 46.4182, 66.8054, 63.3828, 64.304,  59.4519, 51.959,  57.4406, 60.3125};

double d65(double wavelength) {
  const double at = (wavelength - first_wavelength) / 10.0;
  const auto i = std::min(static_cast<std::size_t>(at), d65_table.size() - 2);
  return std::lerp(d65_table[i], d65_table[i + 1], at - static_cast<double>(i));
}

double value_at(const SampledSpectrum& spectrum, double wavelength) {
  const std::vector<double>& w = spectrum.wavelengths;
  if (w.empty() || wavelength < w.front() || wavelength > w.back()) return 0.0;
  const auto above = std::ranges::upper_bound(w, wavelength);
  if (above == w.end()) return spectrum.values.back();
  const auto i = static_cast<std::size_t>(above - w.begin());
  return std::lerp(spectrum.values[i - 1], spectrum.values[i], (wavelength - w[i - 1]) / (w[i] - w[i - 1]));
}

/// Integral over the visible wavelengths of f(wavelength) times the matching functions.
template <class Function>
V3d integrate(const Function& f) {
  // Midpoints of quarter nanometres: spectra jump where they begin and end.
  constexpr int steps = 1880;
  constexpr double step = (last_wavelength - first_wavelength) / steps;
  V3d sum(0.0);
  for (int i = 0; i < steps; ++i) {
    const double wavelength = first_wavelength + (i + 0.5) * step;
    sum += cie_xyz(wavelength) * (f(wavelength) * step);
  }
  return sum;
}

}  // namespace

V3d cie_xyz(double wavelength) {
  // A Gaussian of unit height with different widths on its two sides.
  const auto lobe = [&](double height, double mean, double below, double above) {
    const double t = (wavelength - mean) / (wavelength < mean ? below : above);
    return height * std::exp(-0.5 * t * t);
  };
  return {lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2),
          lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
          lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8)};
}

C3d rec709_of_xyz(const V3d& c) {
  // IEC 61966-2-1.
  return {3.240969941904521 * c.x - 1.537383177570093 * c.y - 0.498610760293 * c.z,
          -0.96924363628087 * c.x + 1.87596750150772 * c.y + 0.041555057407175 * c.z,
          0.055630079696993 * c.x - 0.20397695888897 * c.y + 1.056971514242878 * c.z};
}

C3d reflectance_of_spectrum(const SampledSpectrum& spectrum) {
  const V3d seen = integrate([&](double w) { return d65(w) * value_at(spectrum, w); });
  static const V3d white = integrate(d65);
  // Channel by channel relative to the white of the same integral, so that the fit's error does not tint greys.
  const V3d d65_white(0.950455927051672, 1.0, 1.089057750759878);
  return rec709_of_xyz({seen.x / white.x * d65_white.x, seen.y / white.y, seen.z / white.z * d65_white.z});
}

C3d emission_of_spectrum(const SampledSpectrum& spectrum) {
  const V3d seen = integrate([&](double w) { return value_at(spectrum, w); });
  static const V3d one = integrate([](double) { return 1.0; });
  return rec709_of_xyz({seen.x / one.x, seen.y / one.y, seen.z / one.z});
}

C3d emission_of_uniform_spectrum(double value) { return rec709_of_xyz(V3d(value)); }

}  // namespace twopass
