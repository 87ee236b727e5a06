#include "render/load/spectrum.h"

#include <gtest/gtest.h>

namespace twopass {
namespace {

SampledSpectrum constant(double value) { return {{300, 900}, {value, value}}; }

TEST(Spectrum, ConstantReflectanceIsGrey) {
  const C3d grey = reflectance_of_spectrum(constant(0.25));
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(grey[i], 0.25, 1e-6);
}

TEST(Spectrum, ConstantEmissionIsIlluminantE) {
  const C3d emitted = emission_of_spectrum(constant(2.0)), exact = emission_of_uniform_spectrum(2.0);
  // The colour of equal energy in linear Rec.709: the row sums of the matrix.
  const double expected[3] = {2 * 1.204975, 2 * 0.948279, 2 * 0.908624};
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(exact[i], expected[i], 1e-5);
    EXPECT_NEAR(emitted[i], expected[i], 1e-5);
  }
  // Its luminance is the constant.
  EXPECT_NEAR(0.2126 * emitted[0] + 0.7152 * emitted[1] + 0.0722 * emitted[2], 2.0, 1e-3);
}

TEST(Spectrum, IsLinear) {
  const SampledSpectrum red{{600, 650, 700}, {0, 0.8, 0}}, twice{{600, 650, 700}, {0, 1.6, 0}};
  const C3d once = emission_of_spectrum(red), doubled = emission_of_spectrum(twice);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(doubled[i], 2 * once[i], 1e-12);
}

TEST(Spectrum, BandsHaveTheirColours) {
  const C3d red = reflectance_of_spectrum({{600, 780}, {1, 1}}),
            blue = reflectance_of_spectrum({{400, 480}, {1, 1}}),
            green = reflectance_of_spectrum({{500, 570}, {1, 1}});
  EXPECT_GT(red.x, 5 * std::max(red.y, red.z));
  EXPECT_GT(blue.z, 3 * std::max(blue.x, blue.y));
  EXPECT_GT(green.y, 3 * std::max(green.x, green.z));
}

TEST(Spectrum, MatchingFunctionsPeakWhereTheyShould) {
  // CIE 15: ybar(555) = 1, xbar(600) = 1.0622, zbar(445) = 1.7826.
  EXPECT_NEAR(cie_xyz(555).y, 1.0, 0.01);
  EXPECT_NEAR(cie_xyz(600).x, 1.0622, 0.01);
  EXPECT_NEAR(cie_xyz(445).z, 1.7826, 0.02);
}

TEST(Spectrum, OutsideTheSamplesThereIsNothing) {
  EXPECT_EQ(emission_of_spectrum({{200, 300}, {1, 1}}), C3d(0.0));
}

}  // namespace
}  // namespace twopass
