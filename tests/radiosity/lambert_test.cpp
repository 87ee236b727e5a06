#include "radiosity/lambert.h"

#include <gtest/gtest.h>

#include "tests/radiosity/polygon_samples.h"

namespace twopass {
namespace {

using test::parallelogram;
using test::Random;
using test::reversed;
using test::scaled;
using test::translated;

const V3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
const Polygon ceiling = parallelogram(z, y, x);  // the unit square at height 1, facing down

// Corner of a parallel rectangle a x b at distance c (Howell's catalogue, B-3).
double under_corner(double a, double b, double c) {
  const double p = std::hypot(a, c), q = std::hypot(b, c);
  return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / (2.0 * pi);
}

TEST(PointFormFactor, R2_ClosedFormsOfSquares) {
  EXPECT_RELATIVE(point_form_factor(V3d(0.0), z, ceiling), 0.13853160599489300, 1e-15);
  EXPECT_RELATIVE(point_form_factor(V3d(0.5, 0.5, 0), z, ceiling), 0.23945647046077354, 1e-15);
  const Polygon wall = parallelogram(V3d(0.0), y, z);  // at x = 0, facing +x
  EXPECT_RELATIVE(point_form_factor(V3d(0.5, 0.5, 0), z, wall), 0.19013588238480662, 1e-15);
  EXPECT_RELATIVE(point_form_factor(V3d(1, 0, 0), z, wall), 0.055734197002553502, 1e-15);
}

TEST(PointFormFactor, R2_CubeSeenFromTheFloorIsClosed) {
  const Polygon walls[] = {ceiling, parallelogram(V3d(0.0), y, z), parallelogram(x, z, y),
                           parallelogram(V3d(0.0), z, x), parallelogram(y, x, z)};
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const V3d p(random.in(0, 1), random.in(0, 1), 0);
    double sum = 0.0;
    for (const Polygon& wall : walls) sum += point_form_factor(p, z, wall);
    EXPECT_NEAR(sum, 1.0, 2e-15);
  }
}

TEST(PointFormFactor, R2_RectanglesInAnyProportionAndDistance) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const double a = std::pow(10.0, random.in(-3, 3)), b = std::pow(10.0, random.in(-3, 3));
    const double c = std::pow(10.0, random.in(-3, 3));
    const Polygon source = parallelogram(z * c, y * b, x * a);
    const double reach = std::max({a, b, c}) / std::min({a, b, c});
    EXPECT_RELATIVE(point_form_factor(V3d(0.0), z, source), under_corner(a, b, c), 1e-14 * reach);
  }
}

TEST(PointFormFactor, HorizonCutsTheSource) {
  // A vertical wall from z = -1 to 1 counts only above the floor.
  const Polygon tall = parallelogram(V3d(0, 0, -1), y, z * 2), upper = parallelogram(V3d(0.0), y, z);
  for (double d : {1e-6, 0.1, 1.0, 30.0}) {
    const V3d p(d, 0.3, 0);
    EXPECT_RELATIVE(point_form_factor(p, z, tall), point_form_factor(p, z, upper), 1e-13);
    // Looking straight at it, both halves count alike.
    EXPECT_RELATIVE(point_form_factor(p, -x, tall), 2.0 * point_form_factor(p, -x, upper), 1e-14);
  }
}

TEST(PointFormFactor, HorizonThroughVerticesAndEdges) {
  // The horizon (z = 0) through two opposite corners of a square that stands on its corner.
  const Polygon diamond = make_polygon(V3d(-1, 0, 0), V3d(0, 0, 1), V3d(1, 0, 0), V3d(0, 0, -1));
  const Polygon upper = make_polygon(V3d(-1, 0, 0), V3d(0, 0, 1), V3d(1, 0, 0));
  const V3d p(0.2, 1.5, 0);
  ASSERT_GT(point_form_factor(p, z, upper), 0.01);
  EXPECT_RELATIVE(point_form_factor(p, z, diamond), point_form_factor(p, z, upper), 1e-15);
  EXPECT_EQ(point_form_factor(V3d(0, 1, 1), z, upper), 0.0) << "touches the horizon from below";
}

TEST(PointFormFactor, ZeroBehindTheSourceInItsPlaneOrBelowTheHorizon) {
  EXPECT_EQ(point_form_factor(z * 2, -z, ceiling), 0.0);
  EXPECT_EQ(point_form_factor(V3d(3, 0, 1), z, ceiling), 0.0);
  EXPECT_EQ(point_form_factor(V3d(0.0), -z, ceiling), 0.0);
  EXPECT_EQ(point_form_factor(V3d(0.0), z, reversed(ceiling)), 0.0);
  EXPECT_EQ(point_form_factor(V3d(0.0), z, Polygon{}), 0.0);
}

TEST(PointFormFactor, SignedVariantIsNegativeForTheBack) {
  EXPECT_EQ(signed_point_form_factor(V3d(0.0), z, reversed(ceiling)),
            -signed_point_form_factor(V3d(0.0), z, ceiling));
}

TEST(PointFormFactor, TendsToOneOverALargeSourceAndToAHalfAtItsEdge) {
  EXPECT_NEAR(point_form_factor(V3d(0.5, 0.5, 1 - 1e-9), z, ceiling), 1.0, 1e-15);
  EXPECT_NEAR(point_form_factor(V3d(0.5, 0.0, 1 - 1e-9), z, ceiling), 0.5, 1e-8);
  EXPECT_NEAR(point_form_factor(V3d(0.0, 0.0, 1 - 1e-9), z, ceiling), 0.25, 1e-8);
}

TEST(PointFormFactor, FarAwayIsCosinesAreaOverPiDistanceSquared) {
  Random random(3);
  for (double distance : {1e3, 1e4, 1e5}) {
    for (int i = 0; i < 200; ++i) {
      const Polygon source = random.inscribed(V3d(0.0), 1.0, 3 + i % 2);
      const V3d centre = polygon_centroid(source), d = random.direction();
      const V3d p = centre + d * distance, n = random.direction();
      const double cosines = n.dot(-d) * polygon_area_vector(source).dot(d);
      if (n.dot(-d) < 0.1 || polygon_area_vector(source).dot(d) < 0.1) continue;
      const double exact = cosines / (pi * distance * distance);
      // The expansion's error 6 (radius / distance)^2, and rounding in proportion to the distance.
      EXPECT_RELATIVE(point_form_factor(p, n, source), exact, 6.0 / (distance * distance) + 1e-14 * distance);
    }
  }
}

TEST(PointFormFactor, SourceMayBeCutInPieces) {
  Random random(4);
  for (int i = 0; i < 2000; ++i) {
    const Polygon source = random.inscribed(V3d(0.0), 1.0, 4);
    const V3d p = random.in_cube(2.0), n = random.direction();
    const double whole = point_form_factor(p, n, source);
    const double cut_a = point_form_factor(p, n, make_polygon(source.v[0], source.v[1], source.v[2])) +
                         point_form_factor(p, n, make_polygon(source.v[0], source.v[2], source.v[3]));
    const double cut_b = point_form_factor(p, n, make_polygon(source.v[1], source.v[2], source.v[3])) +
                         point_form_factor(p, n, make_polygon(source.v[1], source.v[3], source.v[0]));
    EXPECT_NEAR(cut_a, whole, 1e-15);
    EXPECT_NEAR(cut_b, whole, 1e-15);
  }
}

TEST(PointFormFactor, AnySizeAndOrientation) {
  Random random(5);
  for (int i = 0; i < 500; ++i) {
    const Polygon source = random.inscribed(V3d(0.0), 1.0, 3 + i % 2);
    const V3d p = random.in_cube(2.0), n = random.direction();
    const double value = point_form_factor(p, n, source);
    EXPECT_GE(value, 0.0);
    EXPECT_LE(value, 1.0);
    for (double factor : {1e-6, 1e6, 1e30})
      EXPECT_NEAR(point_form_factor(p * factor, n, scaled(source, factor)), value, 1e-15);
    const test::Rotation rotation = random.rotation();
    EXPECT_NEAR(point_form_factor(rotation(p), rotation(n), rotation(source)), value, 1e-14);
  }
}

TEST(PointFormFactor, OnTheBoundaryAndDegenerateSourcesAreFinite) {
  const Polygon wall = parallelogram(V3d(0.0), y, z);
  for (const V3d& p : {V3d(0.0), V3d(0, 0.5, 0), y, V3d(0, -1, 0), V3d(1e-300, 0.5, 0)}) {
    const double value = point_form_factor(p, z, wall);
    EXPECT_TRUE(value >= 0.0 && value <= 0.5) << value;
  }
  for (const Polygon& flat :
       {make_polygon(y, y, y), make_polygon(V3d(0.0), y, y * 2), make_polygon(z, z + y, z + y, z)})
    EXPECT_EQ(point_form_factor(V3d(0, 0, 0.5), z, flat), 0.0);
}

TEST(PointFormFactor, DuplicateVerticesChangeNothing) {
  const Polygon triangle = make_polygon(z, z + y, z + x), doubled = make_polygon(z, z + y, z + y, z + x);
  const V3d p(0.3, 0.1, 0);
  EXPECT_RELATIVE(point_form_factor(p, z, doubled), point_form_factor(p, z, triangle), 1e-15);
}

}  // namespace
}  // namespace twopass
