#include "radiosity/smooth_groups.h"

#include <gtest/gtest.h>

namespace twopass {
namespace {

V3f at_degrees(double angle) {
  return {static_cast<float>(std::cos(angle * pi / 180.0)), static_cast<float>(std::sin(angle * pi / 180.0)),
          0.0f};
}

std::vector<std::uint32_t> groups(const std::vector<V3f>& normals) {
  std::vector<std::uint32_t> label;
  smooth_groups(normals, label);
  return label;
}

using Labels = std::vector<std::uint32_t>;

TEST(SmoothGroups, StepsOfLessThanThirtyDegreesJoin) {
  EXPECT_EQ(groups({at_degrees(0), at_degrees(29), at_degrees(58)}), (Labels{0, 0, 0}));
  EXPECT_EQ(groups({at_degrees(0), at_degrees(31), at_degrees(58)}), (Labels{0, 1, 1}));
  EXPECT_EQ(groups({at_degrees(0), at_degrees(90), at_degrees(1), at_degrees(180)}), (Labels{0, 1, 0, 2}));
  EXPECT_EQ(groups({}), Labels{});
}

TEST(SmoothGroups, TrianglesWithoutAreaAreAlone) {
  EXPECT_EQ(groups({V3f(0.0f), at_degrees(0), V3f(0.0f), at_degrees(0)}), (Labels{0, 1, 2, 1}));
}

TEST(SmoothGroups, LargeFansAreJoinedAroundTheTipAndTwoSheetsStayApart) {
  std::vector<V3f> fan;
  for (int k = 0; k < 1000; ++k) fan.push_back(at_degrees(0.1 * k));
  for (int k = 0; k < 1000; ++k) fan.push_back(at_degrees(180.0 + 0.05 * k));
  const Labels label = groups(fan);
  for (std::size_t k = 0; k < fan.size(); ++k) EXPECT_EQ(label[k], k < 1000 ? 0u : 1u) << k;
}

// A million pairs would be nothing; 1e10 would be a minute.
TEST(SmoothGroups, WorkGrowsWithTheNormals) {
  std::vector<V3f> star;
  for (int k = 0; k < 100000; ++k) {
    const double z = 2.0 * (k + 0.5) / 100000 - 1.0, r = std::sqrt(1.0 - z * z);
    star.push_back(V3f(V3d(r * std::cos(2.4 * k), r * std::sin(2.4 * k), z)));
  }
  EXPECT_EQ(groups(star), Labels(star.size(), 0));
}

}  // namespace
}  // namespace twopass
