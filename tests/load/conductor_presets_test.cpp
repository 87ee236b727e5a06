// The indices of metals by name against their measured spectra, reduced to channels here.
#include "materials/conductor_presets.h"

#include <gtest/gtest.h>

#include "materials/fresnel.h"
#include "render/load/spectrum.h"

namespace twopass {
namespace {

// eta and k of Ag, Al, Au, Cu by wavelength in nanometres: luxpop.com, as distributed with Mitsuba (the range
// from 300 to 890 nm; here what is visible).
const struct {
  double wavelength, value[8];
} measured[] = {
    {359.374, {0.194813, 1.53375, 0.39575, 4.365, 1.727625, 1.852375, 1.281563, 1.931688}},
    {364.659, {0.186, 1.61, 0.407, 4.43, 1.716, 1.862, 1.27, 1.95}},
    {370.102, {0.192063, 1.641875, 0.419125, 4.49375, 1.705875, 1.883, 1.249062, 1.972438}},
    {375.71, {0.2, 1.67, 0.432, 4.56, 1.696, 1.906, 1.225, 2.015}},
    {381.49, {0.198063, 1.735, 0.445688, 4.63375, 1.68475, 1.9225, 1.2, 2.121562}},
    {387.451, {0.192, 1.81, 0.46, 4.71, 1.674, 1.936, 1.18, 2.21}},
    {393.601, {0.182, 1.87875, 0.474688, 4.784375, 1.666, 1.94775, 1.174375, 2.177188}},
    {399.949, {0.173, 1.95, 0.49, 4.86, 1.658, 1.956, 1.175, 2.13}},
    {406.505, {0.172625, 2.029375, 0.506188, 4.938125, 1.64725, 1.959375, 1.1775, 2.160063}},
    {413.281, {0.173, 2.11, 0.523, 5.02, 1.636, 1.958, 1.18, 2.21}},
    {420.285, {0.166688, 2.18625, 0.540063, 5.10875, 1.628, 1.951375, 1.178125, 2.249938}},
    {427.532, {0.16, 2.26, 0.558, 5.2, 1.616, 1.94, 1.175, 2.289}},
    {435.032, {0.1585, 2.329375, 0.577313, 5.29, 1.59625, 1.9245, 1.172812, 2.326}},
    {442.801, {0.157, 2.4, 0.598, 5.38, 1.562, 1.904, 1.17, 2.362}},
    {450.852, {0.151063, 2.47875, 0.620313, 5.48, 1.502125, 1.875875, 1.165312, 2.397625}},
    {459.201, {0.144, 2.56, 0.644, 5.58, 1.426, 1.846, 1.16, 2.433}},
    {467.865, {0.137313, 2.64, 0.668625, 5.69, 1.345875, 1.814625, 1.155312, 2.469187}},
    {476.862, {0.132, 2.72, 0.695, 5.8, 1.242, 1.796, 1.15, 2.504}},
    {486.212, {0.13025, 2.798125, 0.72375, 5.915, 1.08675, 1.797375, 1.142812, 2.535875}},
    {495.937, {0.13, 2.88, 0.755, 6.03, 0.916, 1.84, 1.135, 2.564}},
    {506.058, {0.129938, 2.97375, 0.789, 6.15, 0.7545, 1.9565, 1.131562, 2.589625}},
    {516.601, {0.13, 3.07, 0.826, 6.28, 0.608, 2.12, 1.12, 2.605}},
    {527.592, {0.130063, 3.159375, 0.867, 6.42, 0.49175, 2.32625, 1.092437, 2.595562}},
    {539.062, {0.129, 3.25, 0.912, 6.55, 0.402, 2.54, 1.04, 2.583}},
    {551.041, {0.124375, 3.348125, 0.963, 6.7, 0.3455, 2.730625, 0.950375, 2.5765}},
    {563.564, {0.12, 3.45, 1.02, 6.85, 0.306, 2.88, 0.826, 2.599}},
    {576.671, {0.119313, 3.55375, 1.08, 7, 0.267625, 2.940625, 0.645875, 2.678062}},
    {590.401, {0.121, 3.66, 1.15, 7.15, 0.236, 2.97, 0.468, 2.809}},
    {604.801, {0.1255, 3.76625, 1.22, 7.31, 0.212375, 3.015, 0.35125, 3.01075}},
    {619.921, {0.131, 3.88, 1.3, 7.48, 0.194, 3.06, 0.272, 3.24}},
    {635.816, {0.136125, 4.010625, 1.39, 7.65, 0.17775, 3.07, 0.230813, 3.458187}},
    {652.548, {0.14, 4.15, 1.49, 7.82, 0.166, 3.15, 0.214, 3.67}},
    {670.185, {0.140063, 4.293125, 1.6, 8.01, 0.161, 3.445812, 0.20925, 3.863125}},
    {688.801, {0.14, 4.44, 1.74, 8.21, 0.16, 3.8, 0.213, 4.05}},
    {708.481, {0.144313, 4.58625, 1.91, 8.39, 0.160875, 4.087687, 0.21625, 4.239563}},
    {729.319, {0.148, 4.74, 2.14, 8.57, 0.164, 4.357, 0.223, 4.43}},
    {751.419, {0.145875, 4.908125, 2.41, 8.62, 0.1695, 4.610188, 0.2365, 4.619563}},
    {774.901, {0.143, 5.09, 2.63, 8.6, 0.176, 4.86, 0.25, 4.817}},
    {799.898, {0.142563, 5.28875, 2.8, 8.45, 0.181375, 5.125813, 0.254188, 5.034125}},
    {826.561, {0.145, 5.5, 2.74, 8.31, 0.188, 5.39, 0.26, 5.26}},
    {855.063, {0.151938, 5.720624, 2.58, 8.21, 0.198125, 5.63125, 0.28, 5.485625}},
    {885.601, {0.163, 5.95, 2.24, 8.21, 0.21, 5.88, 0.3, 5.717}},
};

SampledSpectrum column(int i) {
  SampledSpectrum spectrum;
  for (const auto& row : measured) {
    spectrum.wavelengths.push_back(row.wavelength);
    spectrum.values.push_back(row.value[i]);
  }
  return spectrum;
}

// The table holds integrals over the tabulated CIE observer; here its fit by three Gaussians, good to about 1 %
// of the peaks, in place of a second table.
TEST(ConductorPresets, AreIntegralsOfTheSpectra) {
  const char* names[] = {"Ag", "Al", "Au", "Cu"};
  for (int i = 0; i < 4; ++i) {
    const ConductorIndex index = conductor_index_of(names[i], "here");
    const C3d eta = emission_of_spectrum(column(2 * i)), k = emission_of_spectrum(column(2 * i + 1));
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(index.eta[c], eta[c], 0.01 * std::max({eta.x, eta.y, eta.z})) << names[i] << ' ' << c;
      EXPECT_NEAR(index.k[c], k[c], 0.01 * std::max({k.x, k.y, k.z})) << names[i] << ' ' << c;
    }
  }
}

// What is lost by reducing the index instead of the reflectance: the colour of a metal under D65 comes out this
// near.
TEST(ConductorPresets, ReflectTheColourOfTheSpectrum) {
  const char* names[] = {"Ag", "Al", "Au", "Cu"};
  for (int i = 0; i < 4; ++i) {
    SampledSpectrum reflected;
    for (const auto& row : measured) {
      reflected.wavelengths.push_back(row.wavelength);
      reflected.values.push_back(fresnel_conductor(1.0f, C3f(static_cast<float>(row.value[2 * i])),
                                                   C3f(static_cast<float>(row.value[2 * i + 1])))
                                     .x);
    }
    const ConductorIndex index = conductor_index_of(names[i], "here");
    const C3f ours = fresnel_conductor(1.0f, index.eta, index.k);
    const C3d exact = reflectance_of_spectrum(reflected);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(ours[c], exact[c], 0.06) << names[i] << ' ' << c;
  }
}

}  // namespace
}  // namespace twopass
