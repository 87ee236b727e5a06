#include "radiosity/hemicube_pixels.h"

#include <gtest/gtest.h>

namespace twopass {
namespace {

TEST(HemicubePixels, AreUnitDirectionsWithWeightsThatAddUpToOne) {
  for (const int resolution : {2, 10, 64}) {
    const std::vector<HemicubePixel> pixels = hemicube_pixels(resolution);
    EXPECT_EQ(pixels.size(), 3u * resolution * resolution);
    double sum = 0.0;
    for (const HemicubePixel& pixel : pixels) {
      EXPECT_NEAR(pixel.direction.length(), 1.0, 1e-15);
      EXPECT_GT(pixel.direction.z, 0.0);
      EXPECT_GT(pixel.weight, 0.0);
      sum += pixel.weight;
    }
    EXPECT_NEAR(sum, 1.0, 1e-13);
  }
}

// The point under the middle of a unit square at the distance 1, and the half space around an axis.
TEST(HemicubePixels, IntegrateFormFactors) {
  double square = 0.0, cone = 0.0, quarter = 0.0;
  for (const auto& [d, weight] : hemicube_pixels(256)) {
    if (std::max(std::abs(d.x), std::abs(d.y)) < 0.5 * d.z) square += weight;
    if (d.z * d.z > 0.5) cone += weight;
    if (d.x > 0.0 && d.y > 0.0) quarter += weight;
  }
  EXPECT_NEAR(square, 0.23945647046077354, 1e-5);
  EXPECT_NEAR(cone, 0.5, 1e-3);  // pixels on the rim
  EXPECT_NEAR(quarter, 0.25, 1e-13);
}

}  // namespace
}  // namespace twopass
