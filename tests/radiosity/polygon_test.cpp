#include "radiosity/polygon.h"

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
const Polygon unit_square = parallelogram(V3d(0.0), x, y);

TEST(Polygon, AreaVectorPointsOutOfTheFront) {
  EXPECT_EQ(polygon_area_vector(unit_square), z);
  EXPECT_EQ(polygon_area_vector(reversed(unit_square)), -z);
  EXPECT_EQ(polygon_area_vector(make_polygon(V3d(0.0), y, z)), x * 0.5);
}

TEST(Polygon, AreaOfRandomParallelogramsIsTheCrossProduct) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const V3d u = random.in_cube(2.0), v = random.in_cube(2.0);
    EXPECT_RELATIVE(polygon_area(parallelogram(random.in_cube(1.0), u, v)), u.cross(v).length(), 1e-13);
  }
}

TEST(Polygon, ThinTriangleKeepsItsArea) {
  // (1, 1, 1) x (1, 1, 1 + t) = t (1, -1, 0) exactly; the plain products would leave 1e-2 of noise.
  const double t = 0x1p-46;
  const V3d a(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0), b(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0 + t);
  const double exact = (b.z - a.z) * a.x * std::sqrt(2.0) / 2.0;
  EXPECT_RELATIVE(polygon_area(make_polygon(V3d(0.0), a, b)), exact, 1e-15);
}

TEST(Polygon, DifferenceOfProductsSurvivesCancellation) {
  const double e = 0x1p-30;
  EXPECT_EQ(difference_of_products(1.0 + e, 1.0 - e, 1.0, 1.0), -e * e);  // plainly: 0
  EXPECT_EQ((1.0 + e) * (1.0 - e) - 1.0, 0.0);
}

TEST(Polygon, CentroidOfTrianglesParallelogramsAndAKite) {
  EXPECT_EQ(polygon_centroid(unit_square), V3d(0.5, 0.5, 0));
  EXPECT_LT((polygon_centroid(make_polygon(V3d(0.0), x * 3, y * 6)) - V3d(1, 2, 0)).length(), 1e-15);
  // Two triangles over the base from (0,-1) to (0,1): apex at 2 (area 2, centroid 2/3) and at -1 (area 1,
  // -1/3).
  const Polygon kite = make_polygon(V3d(-1, 0, 0), -y, V3d(2, 0, 0), y);
  EXPECT_LT((polygon_centroid(kite) - V3d((2 * (2.0 / 3) - 1.0 / 3) / 3, 0, 0)).length(), 1e-15);
}

TEST(Polygon, CentroidFarFromTheOriginKeepsItsDigits) {
  const V3d offset(1e9, -1e9, 1e9);
  EXPECT_EQ(polygon_centroid(translated(unit_square, offset)), offset + V3d(0.5, 0.5, 0));
}

TEST(Polygon, CentroidOfADegeneratePolygonIsTheMeanOfItsVertices) {
  EXPECT_EQ(polygon_centroid(make_polygon(V3d(0.0), x, x * 2, x)), x);
  EXPECT_EQ(polygon_centroid(make_polygon(y, y, y, y)), y);
}

TEST(Polygon, RadiusIsTheFarthestVertex) {
  EXPECT_RELATIVE(polygon_radius(unit_square, V3d(0.5, 0.5, 0)), std::sqrt(0.5), 1e-15);
  EXPECT_EQ(polygon_radius(unit_square, V3d(0.0)), std::sqrt(2.0));
}

TEST(Clip, KeepsAllOrNothing) {
  EXPECT_EQ(clip(unit_square, V3d(-1, 0, 0), x).n, 4);
  EXPECT_TRUE(clip(unit_square, V3d(2, 0, 0), x).empty());
  EXPECT_EQ(clip(unit_square, V3d(0.0), x).n, 4) << "an edge in the plane is no cut";
  EXPECT_TRUE(clip(unit_square, V3d(1, 0, 0), x).empty()) << "touching from behind";
  EXPECT_TRUE(clip(unit_square, V3d(0.0), z).empty()) << "lying in the plane";
  EXPECT_TRUE(clip(Polygon{}, V3d(0.0), z).empty());
}

TEST(Clip, CutsHalvesAndCorners) {
  const Polygon half = clip(unit_square, V3d(0.25, 0, 0), x * 7.0);
  EXPECT_EQ(half.n, 4);
  EXPECT_RELATIVE(polygon_area(half), 0.75, 1e-15);
  const Polygon corner = clip(unit_square, V3d(0.5, 0, 0), V3d(-1, -1, 0));
  EXPECT_EQ(corner.n, 3);
  EXPECT_RELATIVE(polygon_area(corner), 0.125, 1e-15);
  const Polygon rest = clip(unit_square, V3d(0.5, 0, 0), V3d(1, 1, 0));
  EXPECT_EQ(rest.n, 5);
  EXPECT_RELATIVE(polygon_area(rest), 0.875, 1e-15);
  EXPECT_EQ(clip(unit_square, V3d(0.0), V3d(1, -1, 0)).n, 3) << "through two vertices: no new ones";
}

TEST(Clip, TheTwoPartsMakeTheWhole) {
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const Polygon polygon = random.inscribed(random.in_cube(1.0), 1.0, 3 + i % 2);
    const V3d point = random.in_cube(1.0), normal = random.direction();
    const Polygon front = clip(polygon, point, normal), back = clip(polygon, point, -normal);
    EXPECT_LE(front.n, polygon.n + 1);
    const V3d sum = polygon_area_vector(front) + polygon_area_vector(back);
    EXPECT_LT((sum - polygon_area_vector(polygon)).length(), 1e-14);
  }
}

TEST(Clip, NeverOverflowsWhenVerticesAlternate) {
  // Bow ties are no valid input, but rounding can make a sliver look like one.
  Polygon bow_tie = make_polygon(V3d(0.0), V3d(1, 1, 0), V3d(1, 0, 0), V3d(0, 1, 0));
  for (int i = 0; i < 4; ++i) bow_tie = clip(bow_tie, V3d(0.5, 0.5, 0) + y * (1e-3 * i), y);
  EXPECT_LE(bow_tie.n, 8);
}

TEST(Coplanar, SamePlaneInAnyPositionUpToRounding) {
  Random random(3);
  for (int i = 0; i < 500; ++i) {
    const test::Rotation rotation = random.rotation();
    const double size = std::pow(10.0, random.in(-6.0, 6.0));
    const V3d offset = random.in_cube(1e4 * size);
    const V3d shift(random.in(-3.0, 3.0), random.in(-3.0, 3.0), 0.0);
    const Polygon a = translated(scaled(rotation(unit_square), size), offset);
    const Polygon b = translated(scaled(rotation(translated(unit_square, shift)), size), offset);
    EXPECT_TRUE(are_coplanar(a, b));
    EXPECT_TRUE(are_coplanar(b, reversed(a)));
    const Polygon lifted =
        translated(scaled(rotation(translated(unit_square, shift + z * 1e-9)), size), offset);
    EXPECT_FALSE(are_coplanar(a, lifted));
  }
}

TEST(Coplanar, TiltedOrParallelPlanesAreNot) {
  EXPECT_FALSE(are_coplanar(unit_square, translated(unit_square, z * 1e-13)));
  EXPECT_FALSE(are_coplanar(unit_square, parallelogram(V3d(0.0), x, y + z * 1e-13)));
  EXPECT_TRUE(are_coplanar(unit_square, parallelogram(V3d(0.0), x, y + z * 1e-17)));
}

TEST(WhollyBehind, StrictlyInFrontCounts) {
  EXPECT_TRUE(is_wholly_behind(unit_square, V3d(0.0), z));
  EXPECT_TRUE(is_wholly_behind(unit_square, V3d(1, 0, 0), x));
  EXPECT_FALSE(is_wholly_behind(unit_square, V3d(0.999, 0, 0), x));
}

}  // namespace
}  // namespace twopass
