#include "render/image/flip_planes.h"

#include <gtest/gtest.h>

namespace twopass {
namespace {

TEST(FlipPlanes, FiltersRepeatTheBorder) {
  Plane in(3, 1);
  in.values = {1.0f, 2.0f, 4.0f};
  const Kernel kernel{1.0f, 10.0f, 100.0f};
  EXPECT_EQ(filter_rows(in, kernel).values, (std::vector<float>{211.0f, 421.0f, 442.0f}));
}

TEST(FlipPlanes, ColumnsKeepTheRowsInside) {
  Plane in(1, 5);
  in.values = {1.0f, 2.0f, 3.0f, 4.0f, 5.0f};
  const Kernel kernel{1.0f, 10.0f, 100.0f};
  EXPECT_EQ(filter_columns(in, kernel, 1).values, (std::vector<float>{321.0f, 432.0f, 543.0f}));
  EXPECT_EQ(filter_columns(in, kernel, 2).values, std::vector<float>{432.0f});
}

TEST(FlipPlanes, WhiteIsNeutral) {
  const C3f ycxcz = linear_to_ycxcz({1.0f, 1.0f, 1.0f});
  EXPECT_NEAR(ycxcz.x, 100.0f, 1e-4f);
  EXPECT_NEAR(ycxcz.y, 0.0f, 1e-3f);
  EXPECT_NEAR(ycxcz.z, 0.0f, 1e-3f);
  const C3f lab = linear_to_hunt_lab({1.0f, 1.0f, 1.0f});
  EXPECT_NEAR(lab.x, 100.0f, 1e-4f);
  EXPECT_NEAR(lab.y, 0.0f, 1e-3f);
  EXPECT_NEAR(lab.z, 0.0f, 1e-3f);
}

TEST(FlipPlanes, TheOpponentSpaceReturns) {
  for (const C3f& rgb : {C3f(0.1f, 0.7f, 0.3f), C3f(1.0f, 0.0f, 0.0f), C3f(0.0f, 0.0f, 1.0f)}) {
    const C3f back = ycxcz_to_linear(linear_to_ycxcz(rgb));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(back[c], rgb[c], 1e-5f);
  }
}

// CIELAB of the sRGB primaries under D65 as colour tables print it, with a and b times 0.01 L.
TEST(FlipPlanes, LabOfThePrimaries) {
  const auto expect = [](const C3f& rgb, float l, float a, float b) {
    const C3f lab = linear_to_hunt_lab(rgb);
    EXPECT_NEAR(lab.x, l, 0.02f);
    EXPECT_NEAR(lab.y, 0.01f * l * a, 0.05f);
    EXPECT_NEAR(lab.z, 0.01f * l * b, 0.05f);
  };
  expect({1.0f, 0.0f, 0.0f}, 53.24f, 80.09f, 67.20f);
  expect({0.0f, 1.0f, 0.0f}, 87.73f, -86.18f, 83.18f);
  expect({0.0f, 0.0f, 1.0f}, 32.30f, 79.19f, -107.86f);
}

TEST(FlipPlanes, HyabIsCityBlockInLightnessOnly) {
  EXPECT_FLOAT_EQ(hyab({10.0f, 0.0f, 0.0f}, {20.0f, 3.0f, 4.0f}), 15.0f);
}

}  // namespace
}  // namespace twopass
