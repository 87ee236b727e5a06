#include "radiosity/shaft.h"

#include <gtest/gtest.h>

#include "tests/radiosity/polygon_samples.h"

namespace twopass {
namespace {

const Polygon ground = make_polygon(V3d(0.0), V3d(1, 0, 0), V3d(0, 1, 0)),
              above = make_polygon(V3d(0, 0, 1), V3d(0, 1, 1), V3d(1, 0, 1));

TEST(Shaft, KeepsWhatIsBetween) {
  const Shaft shaft(ground, above, 1e-14);
  const Polygon small = make_polygon(V3d(0.1, 0.1, 0.5), V3d(0.2, 0.1, 0.5), V3d(0.1, 0.2, 0.6));
  EXPECT_NEAR(polygon_area(shaft.part_inside(small)), polygon_area(small), 1e-15);
  // A large triangle is cut down to the prism's cross section.
  const Polygon large = make_polygon(V3d(-9, -9, 0.5), V3d(9, -9, 0.5), V3d(0, 9, 0.5));
  EXPECT_NEAR(polygon_area(shaft.part_inside(large)), 0.5, 1e-14);
}

TEST(Shaft, DropsWhatIsBesideOrOnlyTouches) {
  const Shaft shaft(ground, above, 1e-14);
  const auto empty = [&](const V3d& a, const V3d& b, const V3d& c) {
    return shaft.part_inside(make_polygon(a, b, c)).empty();
  };
  EXPECT_TRUE(empty({0.6, 0.6, 0.5}, {0.8, 0.6, 0.5}, {0.6, 0.8, 0.5}));  // within the bounds, beyond the hull
  EXPECT_TRUE(empty({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));                    // one of the two
  EXPECT_TRUE(empty({0, 0, 0}, {1, 0, 0}, {0.5, 0, 1}));                  // on the hull
  EXPECT_TRUE(empty({1, 0, 0}, {0, 1, 0}, {1, 1, -1}));                   // from an edge away
  EXPECT_TRUE(empty({0.1, 0.1, 2}, {0.2, 0.1, 2}, {0.1, 0.2, 2}));        // beyond
  EXPECT_FALSE(empty({1, 0, 0}, {0, 1, 0}, {0, 0, 0.5}));                 // from an edge inwards
}

// No point of the hull may be lost: the middle between points of both is inside.
TEST(Shaft, HoldsAllLinesBetweenRandomTriangles) {
  test::Random random(7);
  for (int n = 0; n < 300; ++n) {
    Polygon a = random.inscribed(V3d(0.0), 1.0, 3), b = random.inscribed(random.direction() * 1.5, 0.7, 3);
    const Polygon front_a = clip(a, b.v[0], polygon_area_vector(b)),
                  front_b = clip(b, a.v[0], polygon_area_vector(a));
    if (front_a.empty() || front_b.empty()) continue;
    const Shaft shaft(front_a, front_b, 1e-14);
    const V3d p = polygon_centroid(front_a), q = polygon_centroid(front_b), middle = (p + q) * 0.5;
    const V3d u = random.direction() * 1e-3, v = random.direction() * 1e-3;
    const Polygon tiny = make_polygon(middle - u - v, middle + u, middle + v);
    EXPECT_FALSE(shaft.part_inside(tiny).empty());
  }
}

}  // namespace
}  // namespace twopass
