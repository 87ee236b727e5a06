#include "radiosity/contour.h"

#include <gtest/gtest.h>

#include "radiosity/lambert.h"
#include "tests/radiosity/polygon_samples.h"

namespace twopass {
namespace {

using test::parallelogram;
using test::Random;
using test::reversed;
using test::translated;

const V3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
const Polygon ground = parallelogram(V3d(0.0), x, y);
const Polygon wall = parallelogram(V3d(0.0), y, z);
constexpr double perpendicular_squares = 0.20004377607540315424;

Polygon ceiling_at(double height) { return parallelogram(z * height, y, x); }

TEST(Contour, R5_ParallelSquaresAtAnyDistance) {
  const double values[][2] = {{0.01, 0.98041660292597327},  {0.1, 0.82699452239725658},
                              {0.5, 0.41525328357714674},   {1.0, 0.19982489569838738304},
                              {2.0, 0.068589588818552448},  {5.0, 0.012403977313245102},
                              {10.0, 0.0031620568387576016}};
  for (const auto& [distance, exact] : values)
    EXPECT_RELATIVE(contour_exchange(ground, ceiling_at(distance)), exact, 1e-13);
  EXPECT_RELATIVE(contour_exchange(ground, translated(ceiling_at(1), x)), 0.086050489152327335, 1e-14);
}

TEST(Contour, R5_R6_SquaresThatTouch) {
  EXPECT_RELATIVE(contour_exchange(ground, wall), perpendicular_squares, 3e-15);
  EXPECT_RELATIVE(contour_exchange(ground, translated(wall, y)), 0.040592230101558543, 1e-14);
  const double dihedral[][2] = {
      {10, 0.849606124962847171}, {30, 0.619028323090803253}, {60, 0.370905321150051436}};
  for (const auto& [degrees, exact] : dihedral) {
    const double angle = degrees * pi / 180;
    const Polygon leaning = parallelogram(V3d(0.0), y, V3d(std::cos(angle), 0, std::sin(angle)));
    EXPECT_RELATIVE(contour_exchange(ground, leaning), exact, 3e-15);
  }
}

TEST(Contour, R7_SquaresWithAGap) {
  EXPECT_RELATIVE(contour_exchange(translated(ground, x), wall), 0.032808826719958734, 1e-14);
}

TEST(Contour, R6_R7_AnyTetrahedronIsClosed) {
  // Edges meet at every angle, and opposite edges are skew: everything at once, with an exact answer.
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    V3d v[4] = {random.in_cube(1), random.in_cube(1), random.in_cube(1), random.in_cube(1)};
    const double volume = (v[1] - v[0]).cross(v[2] - v[0]).dot(v[3] - v[0]);
    if (std::abs(volume) < 1e-3) continue;
    if (volume < 0) std::swap(v[0], v[1]);
    const Polygon face[] = {make_polygon(v[1], v[2], v[3]), make_polygon(v[0], v[3], v[2]),
                            make_polygon(v[0], v[1], v[3]), make_polygon(v[0], v[2], v[1])};
    for (int from = 0; from < 4; ++from) {
      double sum = 0.0;
      for (int to = 0; to < 4; ++to)
        if (to != from)
          sum += contour_exchange(face[from], reversed(face[to])) +
                 contour_exchange(reversed(face[from]), face[to]) + contour_exchange(face[from], face[to]) +
                 contour_exchange(reversed(face[from]), reversed(face[to]));
      EXPECT_NEAR(sum, polygon_area(face[from]), 1e-12);
    }
  }
}

TEST(Contour, R6_RegularTetrahedronIsOneThird) {
  const V3d a(1, 1, 1), b(1, -1, -1), c(-1, 1, -1), d(-1, -1, 1);
  const Polygon abc = make_polygon(a, c, b), abd = make_polygon(a, b, d);
  EXPECT_RELATIVE(contour_exchange(abc, abd) / polygon_area(abc), 1.0 / 3.0, 3e-15);
}

TEST(Contour, EdgesThatMeetLikeATOverlapOrRunAlongEachOther) {
  // The wall's base against floors cut so that edges end in the middle of other edges.
  const double cuts[] = {0.0, 0.3, 0.35, 1.0};
  double sum = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      sum += contour_exchange(
          parallelogram(x * cuts[i] + y * cuts[j], x * (cuts[i + 1] - cuts[i]), y * (cuts[j + 1] - cuts[j])),
          wall);
  EXPECT_RELATIVE(sum, perpendicular_squares, 1e-14);
  // Wide floor, narrow wall and the closed form for it.
  const Polygon wide = parallelogram(V3d(0, -3, 0), x, y * 7);
  EXPECT_RELATIVE(contour_exchange(wide, wall), test::perpendicular_rectangles({0, 1}, {-3, 4}, {0, 1}, {0, 1}),
                  1e-14);
}

TEST(Contour, AlmostTouchingIsAsGoodAsTouching) {
  // The values must run smoothly into the closed forms: the gaps, shifts and tilts below change them by less
  // than 10 gaps.
  const V3d tilt[] = {V3d(0.0), x, y, z};
  for (double gap : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15})
    for (const V3d& t : tilt) {
      const Polygon near_wall = parallelogram(V3d(0.0), y + t * gap, z - t * gap);
      for (const V3d& shift : {x, -x, z, x + y, V3d(-1, 1, 1)})
        EXPECT_NEAR(contour_exchange(ground, translated(near_wall, shift * gap)), perpendicular_squares,
                    10 * gap + 3e-15);
    }
}

TEST(Contour, AlmostTouchingSkewEdgesAreExact) {
  // A floor and a slanted wall whose base passes the floor's edge at a tiny distance, against its two parts
  // that meet at the crossing: neither part has an edge that passes, both have edges that end there.
  for (double gap : {0.0, 1e-15, 1e-9, 1e-6, 1e-3, 0.1}) {
    const V3d base(-gap, -0.2, 0.1), along(0, 1.4, 0.3), up(0.4, 0.1, 1.0);
    const Polygon whole = parallelogram(base, along, up);
    const double t = 0.37;
    const double parts = contour_exchange(ground, parallelogram(base, along * t, up)) +
                         contour_exchange(ground, parallelogram(base + along * t, along * (1 - t), up));
    EXPECT_RELATIVE(contour_exchange(ground, whole), parts, 1e-13);
  }
}

TEST(Contour, PiecesOfVeryDifferentSize) {
  // A small square in the corner of a large floor, against the wall over it: all lengths from 1 to 1e-6.
  for (double s : {1e-1, 1e-2, 1e-3, 1e-4, 1e-6}) {
    const Polygon speck = parallelogram(V3d(0.0), x * s, y * s);
    EXPECT_RELATIVE(contour_exchange(speck, wall),
                    test::perpendicular_rectangles({0, s}, {0, s}, {0, 1}, {0, 1}), 2e-13 + 1e-17 / (s * s));
    // Towards a quarter of a plane: (1/4 + the mean of atan(y/x) / 2 pi over the square) = 3/8, linearly in the
    // size.
    EXPECT_NEAR(contour_exchange(speck, wall) / (s * s), 0.375, 0.15 * s);
  }
}

TEST(Contour, PolygonsThroughEachOthersPlanesAreClipped) {
  const Polygon through_floor = parallelogram(V3d(0, 0, -2), y, z * 3);
  EXPECT_RELATIVE(contour_exchange(ground, through_floor), perpendicular_squares, 3e-15);
  const Polygon through_wall = parallelogram(V3d(-1, 0, 0), x * 2, y);
  EXPECT_RELATIVE(contour_exchange(through_wall, wall), perpendicular_squares, 3e-15);
  EXPECT_RELATIVE(contour_exchange(through_wall, through_floor), perpendicular_squares, 3e-15);
}

TEST(Contour, ClippedRandomPolygonsAgreeWithBruteForce) {
  // Lambert's formula, which clips at every point anew, at the centres of 4096 small triangles.
  Random random(2);
  int compared = 0;
  for (int i = 0; i < 60; ++i) {
    const Polygon a = random.inscribed(V3d(0.0), 1.0, 3),
                  b = random.inscribed(random.in_cube(0.8), 1.0, 3 + i % 2);
    const V3d normal = polygon_area_vector(a).normalized(), u = (a.v[1] - a.v[0]) / 64.0,
              v = (a.v[2] - a.v[0]) / 64.0;
    double sum = 0.0;
    for (int k = 0; k < 64; ++k)
      for (int l = 0; k + l < 64; ++l) {
        sum += point_form_factor(a.v[0] + u * (k + 1 / 3.0) + v * (l + 1 / 3.0), normal, b);
        if (k + l < 63) sum += point_form_factor(a.v[0] + u * (k + 2 / 3.0) + v * (l + 2 / 3.0), normal, b);
      }
    const double mean = sum / 4096.0;
    if (mean > 0.0) ++compared;
    EXPECT_NEAR(contour_exchange(a, b) / polygon_area(a), mean, 4e-4);
  }
  EXPECT_GT(compared, 30);
}

TEST(Contour, NothingBetweenBacksCoplanarOrDegeneratePolygons) {
  EXPECT_EQ(contour_exchange(ground, reversed(ceiling_at(1))), 0.0);
  EXPECT_EQ(contour_exchange(reversed(ground), ceiling_at(1)), 0.0);
  EXPECT_EQ(contour_exchange(ground, ground), 0.0);
  EXPECT_EQ(contour_exchange(ground, translated(ground, x)), 0.0);
  EXPECT_EQ(contour_exchange(ground, Polygon{}), 0.0);
  EXPECT_EQ(contour_exchange(ground, make_polygon(z, z, z)), 0.0);
  EXPECT_EQ(contour_exchange(ground, make_polygon(z, z + x, z + x * 2)), 0.0);
}

TEST(Contour, FewerDigitsWhenFewerAreAskedFor) {
  Random random(3);
  for (double accuracy : {1e-2, 1e-4, 1e-6, 1e-9}) {
    for (int i = 0; i < 200; ++i) {
      const Polygon a = random.inscribed(V3d(0.0), 1.0, 3),
                    b = random.inscribed(random.direction() * 1.5, 1.0, 4);
      const double exact = contour_exchange(a, b);
      if (exact > 1e-4) {
        EXPECT_RELATIVE(contour_exchange(a, b, accuracy), exact, accuracy);
      }
    }
  }
}

}  // namespace
}  // namespace twopass
