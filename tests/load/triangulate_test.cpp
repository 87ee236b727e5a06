#include "render/load/triangulate.h"

#include <set>

#include <gtest/gtest.h>

namespace twopass {
namespace {

V3d area_vector(const std::vector<V3f>& p, const std::array<std::uint32_t, 3>& t) {
  return (V3d(p[t[1]]) - V3d(p[t[0]])).cross(V3d(p[t[2]]) - V3d(p[t[0]])) * 0.5;
}

/// Triangles of a simple polygon: as many as there must be, all facing its way, their areas adding up to its
/// own.
void expect_partition(const std::vector<V3f>& p, double area, const V3d& normal) {
  const auto triangles = triangulate(p);
  ASSERT_EQ(triangles.size(), p.size() - 2);
  double sum = 0.0;
  for (const auto& t : triangles) {
    EXPECT_GE(area_vector(p, t).dot(normal), 0.0);
    sum += area_vector(p, t).length();
  }
  EXPECT_NEAR(sum, area, 1e-6 * area);
}

TEST(Triangulate, FansConvexPolygonsFromTheirFirstCorner) {
  const std::vector<V3f> quad = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const auto triangles = triangulate(quad);
  ASSERT_EQ(triangles.size(), 2u);
  EXPECT_EQ(triangles[0], (std::array<std::uint32_t, 3>{0, 1, 2}));
  EXPECT_EQ(triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
}

TEST(Triangulate, CutsArrowheads) {
  // The notch at every corner in turn: the fan from corner 0 is right for one of them only.
  const std::vector<V3f> arrow = {{0, 0, 0}, {2, 1, 0}, {0, 2, 0}, {0.5f, 1, 0}};
  for (std::size_t shift = 0; shift < 4; ++shift) {
    std::vector<V3f> turned = arrow;
    std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(shift), turned.end());
    expect_partition(turned, 1.5, {0, 0, 1});
    std::reverse(turned.begin(), turned.end());
    expect_partition(turned, 1.5, {0, 0, -1});
  }
}

TEST(Triangulate, CutsAComb) {
  // Teeth of height 1 and width 1 on a bar of height 1, in the plane x + y + z = 0 or so.
  std::vector<V3f> comb;
  const auto point = [](float x, float y) { return V3f(x, y, 0.5f * x - 0.25f * y); };
  const int teeth = 7;
  comb.push_back(point(0, 0));
  comb.push_back(point(2 * teeth - 1, 0));
  for (int i = teeth - 1; i >= 0; --i) {
    const auto x = static_cast<float>(2 * i);
    comb.push_back(point(x + 1, 2));
    comb.push_back(point(x, 2));
    if (i > 0) {
      comb.push_back(point(x, 1));
      comb.push_back(point(x - 1, 1));
    }
  }
  const double slope = std::sqrt(1.0 + 0.25 + 0.0625);
  expect_partition(comb, slope * (2 * teeth - 1 + teeth), {-0.5, 0.25, 1.0});
}

TEST(Triangulate, CutsBentQuads) {
  const std::vector<V3f> bent = {{0, 0, 0}, {1, 0, 0.1f}, {1, 1, 0}, {0, 1, 0.1f}};
  EXPECT_EQ(triangulate(bent).size(), 2u);
}

TEST(Triangulate, AlwaysAnswers) {
  const std::vector<V3f> bow_tie = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(triangulate(bow_tie).size(), 2u);
  const std::vector<V3f> line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {1.5f, 0, 0}};
  EXPECT_EQ(triangulate(line).size(), 3u);
  const std::vector<V3f> point(6, V3f(1.0f));
  EXPECT_EQ(triangulate(point).size(), 4u);
  std::vector<V3f> pentagram;
  for (int i = 0; i < 5; ++i) {
    const float angle = 4.0f * pi_f * static_cast<float>(i) / 5.0f;
    pentagram.emplace_back(std::cos(angle), std::sin(angle), 0.0f);
  }
  EXPECT_EQ(triangulate(pentagram).size(), 3u);
}

TEST(Triangulate, IsScaleFree) {
  for (const float scale : {1e-15f, 1e12f}) {
    const std::vector<V3f> arrow = {V3f(0, 0, 0) * scale, V3f(2, 1, 0) * scale, V3f(0, 2, 0) * scale,
                                    V3f(0.5f, 1, 0) * scale};
    expect_partition(arrow, 1.5 * double(scale) * double(scale), {0, 0, 1});
  }
}

}  // namespace
}  // namespace twopass
