#include "radiosity/patch.h"

#include <gtest/gtest.h>

#include "render/core/sampler.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

const Sphere ball{V3f(1.0f, 2.0f, 3.0f), 2.0f, false};

TEST(Patch, SidesOfATriangleHaveOppositeNormalsAndEqualAreas) {
  const Mesh mesh = test::quad(V3f(0.0f), V3f(2, 0, 0), V3f(0, 3, 0));
  const Patch up = triangle_patch(mesh, 0, front), down = triangle_patch(mesh, 0, back);
  EXPECT_EQ(up.normal, V3d(0, 0, 1));
  EXPECT_EQ(down.normal, V3d(0, 0, -1));
  EXPECT_DOUBLE_EQ(up.area, 3.0);
  EXPECT_DOUBLE_EQ(polygon_area_vector(down.polygon()).z, -3.0);
}

TEST(Patch, OctantsCoverTheSphere) {
  double area = 0.0;
  for (std::uint32_t octant = 0; octant < 8; ++octant) {
    const std::array<V3d, 3> corner = octant_corners(octant);
    EXPECT_GT(corner[0].cross(corner[1]).dot(corner[2]), 0.0) << octant;
    area += spherical_patch(ball, corner, front).area;
  }
  EXPECT_NEAR(area, 4.0 * pi * 4.0, 1e-12);
}

TEST(Patch, PointsOfASphericalPatchLieOnItsSideOfTheSphere) {
  for (const Side side : {front, back}) {
    const Patch patch = spherical_patch(ball, octant_corners(5), side);
    EXPECT_GT(polygon_area_vector(patch.polygon()).dot(patch.normal), 0.0);
    V3d mean(0.0);
    for (std::uint32_t k = 0; k < 256; ++k) {
      const ElementPoint point = patch.sample(Sampler(1, 2, k).next_2d());
      const V3d outward = point.position - V3d(ball.center);
      EXPECT_NEAR(outward.length(), 2.0, 1e-6);
      EXPECT_NEAR(point.normal.dot(outward), side == front ? 2.0 : -2.0, 1e-6);
      EXPECT_LT(outward.x, 1e-6);
      EXPECT_GT(outward.y, -1e-6);
      EXPECT_LT(outward.z, 1e-6);
      mean += outward * (1.0 / 256.0);
    }
    // The centre of mass of an octant of the unit sphere is at 1/2 on each axis.
    EXPECT_NEAR(mean.x, -1.0, 0.02);
    EXPECT_NEAR(mean.y, 1.0, 0.02);
    EXPECT_NEAR(mean.z, -1.0, 0.02);
  }
}

TEST(Patch, DegenerateTrianglesHaveNoAreaAndNoNormal) {
  Mesh mesh;
  mesh.positions = {V3f(0.0f), V3f(1.0f), V3f(2.0f)};
  mesh.triangles.emplace_back(0, 1, 2);
  const Patch patch = triangle_patch(mesh, 0, front);
  EXPECT_EQ(patch.area, 0.0);
  EXPECT_EQ(patch.normal, V3d(0.0));
}

}  // namespace
}  // namespace twopass
