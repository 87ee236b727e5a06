#include "radiosity/polygon_cubature.h"

#include <gtest/gtest.h>

#include "tests/radiosity/polygon_samples.h"

namespace twopass {
namespace {

using test::parallelogram;
using test::Random;

// Int x^p y^q over the unit triangle and the unit square.
double factorial(int n) { return n < 2 ? 1.0 : n * factorial(n - 1); }
double triangle_moment(int p, int q) { return factorial(p) * factorial(q) / factorial(p + q + 2); }
double square_moment(int p, int q) { return 1.0 / ((p + 1.0) * (q + 1.0)); }

double cubature_moment(const Cubature& cubature, int p, int q) {
  double sum = 0.0;
  for (int i = 0; i < cubature.n; ++i)
    sum += cubature.points[i].area * std::pow(cubature.points[i].p.x, p) * std::pow(cubature.points[i].p.y, q);
  return sum;
}

TEST(PolygonCubature, IntegratesPolynomialsOfTheStatedDegreeExactly) {
  const Polygon triangle = make_polygon(V3d(0, 0, 0), V3d(1, 0, 0), V3d(0, 1, 0));
  const Polygon square = parallelogram(V3d(0, 0, 0), V3d(1, 0, 0), V3d(0, 1, 0));
  Cubature cubature;
  for (int order = 1; order <= Cubature::max_order; ++order)
    for (int p = 0; p < 2 * order; ++p)
      for (int q = 0; p + q < 2 * order; ++q) {
        make_cubature(triangle, V3d(0, 0, 1), order, cubature);
        EXPECT_EQ(cubature.n, order * order);
        EXPECT_NEAR(cubature_moment(cubature, p, q) / triangle_moment(p, q), 1.0, 1e-13) << order << p << q;
        make_cubature(square, V3d(0, 0, 1), order, cubature);
        EXPECT_EQ(cubature.n, order * order);
        EXPECT_NEAR(cubature_moment(cubature, p, q) / square_moment(p, q), 1.0, 1e-13) << order << p << q;
      }
}

TEST(PolygonCubature, SharesOfAreaArePositiveAndSumToTheArea) {
  Random random(1);
  Cubature cubature;
  for (int corners = 3; corners <= Polygon::capacity; ++corners)
    for (int order = 1; order <= Cubature::max_order; ++order) {
      const Polygon polygon = random.inscribed(random.in_cube(3.0), 1.0, corners);
      const V3d normal = polygon_area_vector(polygon).normalized();
      make_cubature(polygon, normal, order, cubature);
      double area = 0.0;
      V3d moment(0.0);
      for (int i = 0; i < cubature.n; ++i) {
        EXPECT_GT(cubature.points[i].area, 0.0);
        area += cubature.points[i].area;
        moment += cubature.points[i].p * cubature.points[i].area;
      }
      EXPECT_NEAR(area / polygon_area(polygon), 1.0, 1e-13);
      EXPECT_LT((moment / area - polygon_centroid(polygon)).length(), 1e-13);
    }
}

TEST(PolygonCubature, EmptyPolygonHasNoPoints) {
  Cubature cubature;
  make_cubature(Polygon{}, V3d(0, 0, 1), 3, cubature);
  EXPECT_EQ(cubature.n, 0);
}

}  // namespace
}  // namespace twopass
