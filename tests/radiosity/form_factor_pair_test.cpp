#include "radiosity/form_factor_pair.h"

#include <gtest/gtest.h>

#include "radiosity/lambert.h"
#include "tests/radiosity/polygon_samples.h"

namespace twopass {
namespace {

using test::parallelogram;
using test::Random;
using test::reversed;
using test::scaled;
using test::translated;

const V3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
const Polygon ground = parallelogram(V3d(0.0), x, y);

// Random pairs of polygons, radius 1 and `ratio`, centres `apart` radii of the larger apart, in view of each
// other.
struct Pair {
  Polygon a, b;
};

std::vector<Pair> random_pairs(unsigned seed, int count, double ratio, double apart) {
  Random random(seed);
  std::vector<Pair> pairs;
  for (int i = 0; static_cast<int>(pairs.size()) < count; ++i) {
    const Pair pair{random.inscribed(V3d(0.0), 1.0, 3 + i % 2),
                    random.inscribed(random.direction() * apart * std::max(1.0, ratio), ratio, 3 + i / 2 % 2)};
    const double smaller = std::min(1.0, ratio * ratio), larger = std::max(1.0, ratio * ratio);
    if (exchange_exact(pair.a, pair.b) > 1e-3 * smaller / std::max(1.0, apart * apart / larger))
      pairs.push_back(pair);
  }
  return pairs;
}

TEST(Exchange, ParallelRectanglesInRandomOffsets) {
  Random random(1);
  for (int i = 0; i < 3000; ++i) {
    const double height = std::pow(10.0, random.in(-3, 1));
    double s[4][2];
    for (auto& range : s) range[0] = random.in(-2, 2), range[1] = range[0] + std::pow(10.0, random.in(-1, 0.5));
    const Polygon a = parallelogram(V3d(s[0][0], s[1][0], 0), x * (s[0][1] - s[0][0]), y * (s[1][1] - s[1][0]));
    const Polygon b =
        parallelogram(V3d(s[2][0], s[3][0], height), y * (s[3][1] - s[3][0]), x * (s[2][1] - s[2][0]));
    const double exact = test::parallel_rectangles(s[0], s[1], s[2], s[3], height);
    EXPECT_NEAR(exchange_exact(a, b, 1e-9), exact, 1e-9 * exact + 1e-15);
    EXPECT_NEAR(exchange_exact(a, b), exact, 1e-4 * exact + 1e-15);
  }
}

TEST(Exchange, PerpendicularRectanglesInRandomOffsets) {
  Random random(2);
  for (int i = 0; i < 3000; ++i) {
    double s[4][2];
    for (auto& range : s) range[0] = random.in(-2, 2), range[1] = range[0] + std::pow(10.0, random.in(-1, 0.5));
    for (auto& range : {s[0], s[3]}) {
      const double low = i % 3 == 0 ? 0.0 : std::abs(range[0]);
      range[1] += low - range[0];
      range[0] = low;
    }
    const Polygon a = parallelogram(V3d(s[0][0], s[1][0], 0), x * (s[0][1] - s[0][0]), y * (s[1][1] - s[1][0]));
    const Polygon b = parallelogram(V3d(0, s[2][0], s[3][0]), y * (s[2][1] - s[2][0]), z * (s[3][1] - s[3][0]));
    const double exact = test::perpendicular_rectangles(s[0], s[1], s[2], s[3]);
    EXPECT_NEAR(exchange_exact(a, b, 1e-9), exact, 1e-9 * exact + 1e-15);
    EXPECT_NEAR(exchange_exact(a, b), exact, 1e-4 * exact + 1e-15);
  }
}

// Every rung of the ladder, against a reference that shares none of its code.
TEST(Exchange, MeetsTheAccuracyFromFourRadiiToAHundredThousand) {
  Random random(3);
  for (double apart : {5.0, 6.0, 8.0, 10.0, 15.0, 20.0, 30.0, 50.0, 100.0, 1e3, 1e4, 1e5})
    for (int i = 0; i < 24; ++i) {
      const Polygon a = i % 2 ? random.rotation()(translated(ground, V3d(-0.5, -0.5, 0)))
                              : random.inscribed(V3d(0.0), 1.0, 3);
      const Polygon b = random.inscribed(random.direction() * apart, 1.0, 3);
      const Polygon front_a = is_wholly_behind(b, a.v[0], polygon_area_vector(a)) ? reversed(a) : a;
      const Polygon front_b = is_wholly_behind(a, b.v[0], polygon_area_vector(b)) ? reversed(b) : b;
      if (clip(front_a, b.v[0], polygon_area_vector(front_b)).n != a.n) continue;
      if (clip(front_b, a.v[0], polygon_area_vector(front_a)).n != b.n) continue;
      const double exact = test::far_reference(front_a, front_b);
      if (clip(front_a, b.v[0], -polygon_area_vector(front_b)).n > 0) continue;
      if (clip(front_b, a.v[0], -polygon_area_vector(front_a)).n > 0) continue;
      for (double accuracy : {1e-2, 1e-3, 1e-4, 1e-6, 1e-9})
        EXPECT_RELATIVE(exchange_exact(front_a, front_b, accuracy), exact, accuracy) << "at distance " << apart;
    }
}

TEST(Exchange, MeetsTheAccuracyForAnySizesAndClipping) {
  for (double ratio : {1.0, 0.1, 30.0})
    for (double apart : {0.3, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 10.0, 30.0, 100.0})
      for (const auto& [a, b] : random_pairs(4, 40, ratio, apart)) {
        const double exact = exchange_exact(a, b, 1e-12);
        for (double accuracy : {1e-2, 1e-4, 1e-6, 1e-9})
          EXPECT_RELATIVE(exchange_exact(a, b, accuracy), exact, accuracy)
              << "ratio " << ratio << ", apart " << apart;
      }
}

TEST(Exchange, IsSymmetricToTheLastBit) {
  for (double ratio : {1.0, 0.1})
    for (double apart : {0.3, 1.0, 2.0, 3.0, 5.0, 20.0, 1e3})
      for (const auto& [a, b] : random_pairs(5, 50, ratio, apart))
        for (double accuracy : {1e-4, 1e-9})
          EXPECT_EQ(exchange_exact(a, b, accuracy), exchange_exact(b, a, accuracy));
}

TEST(Exchange, EitherPolygonMayBeCutInPieces) {
  for (double apart : {0.3, 1.0, 2.0, 3.0, 5.0, 20.0, 1e3})
    for (const auto& [a, b] : random_pairs(6, 60, 1.0, apart)) {
      const double whole = exchange_exact(a, b, 1e-10);
      for (const auto& [cut, kept] : {Pair{a, b}, Pair{b, a}}) {
        const V3d centre = polygon_centroid(cut);
        double sum = 0.0;
        for (int i = 0; i < cut.n; ++i)
          sum += exchange_exact(make_polygon(cut.v[i], cut.next(i), centre), kept, 1e-10);
        EXPECT_RELATIVE(sum, whole, 1e-9);
      }
    }
}

TEST(Exchange, ScalesWithTheSquareOfTheSize) {
  for (double apart : {0.3, 1.0, 2.0, 3.0, 5.0, 20.0, 1e3})
    for (const auto& [a, b] : random_pairs(7, 30, 1.0, apart))
      for (double factor : {1e-6, 1e6, 3.7e-20})
        for (double accuracy : {1e-4, 1e-9}) {
          const double value = exchange_exact(a, b, accuracy);
          EXPECT_NEAR(exchange_exact(scaled(a, factor), scaled(b, factor), accuracy) / (factor * factor), value,
                      1e-12 * value + 1e-15);
        }
}

TEST(Exchange, RotationAndTranslationLoseOnlyTheCoordinatesRounding) {
  Random random(8);
  for (double apart : {0.3, 1.0, 2.0, 3.0, 5.0, 20.0})
    for (const auto& [a, b] : random_pairs(8, 30, 1.0, apart)) {
      const double value = exchange_exact(a, b, 1e-9);
      const test::Rotation rotation = random.rotation();
      EXPECT_RELATIVE(exchange_exact(rotation(a), rotation(b), 1e-9), value, 1e-9);
      const V3d offset = random.in_cube(1e4);
      EXPECT_RELATIVE(exchange_exact(translated(a, offset), translated(b, offset), 1e-9), value, 2e-9);
    }
}

TEST(Exchange, FarFromTheOriginExactlyTheSameWhenCoordinatesAreExact) {
  const V3d offset(4096, -8192, 1024);
  const Polygon wall = parallelogram(V3d(0.0), y, z), ceiling = parallelogram(z, y, x);
  for (const Polygon& b : {wall, ceiling})
    EXPECT_EQ(exchange_exact(translated(ground, offset), translated(b, offset), 1e-9),
              exchange_exact(ground, b, 1e-9));
}

TEST(Exchange, SliversSumToTheWhole) {
  // The floor as a fan of slivers with altitudes down to 1e-6, against a wall that shares an edge with it.
  const Polygon wall = parallelogram(V3d(0.0), y, z);
  double from = 0.0, sum = 0.0;
  for (double to : {1e-6, 2e-6, 1e-4, 3e-4, 0.1, 0.1 + 1e-6, 0.9, 1.0}) {
    sum += exchange_exact(make_polygon(V3d(0.0), V3d(1, from, 0), V3d(1, to, 0)), wall, 1e-10);
    from = to;
  }
  sum += exchange_exact(make_polygon(V3d(0.0), V3d(1, 1, 0), V3d(0, 1, 0)), wall, 1e-10);
  EXPECT_RELATIVE(sum, 0.20004377607540315424, 1e-11);
}

TEST(Exchange, ZeroWhereNothingCanBeExchanged) {
  const Polygon ceiling = parallelogram(z, y, x);
  EXPECT_EQ(exchange_exact(ground, reversed(ceiling)), 0.0);
  EXPECT_EQ(exchange_exact(reversed(ground), ceiling), 0.0);
  EXPECT_EQ(exchange_exact(ground, ground), 0.0);
  EXPECT_EQ(exchange_exact(ground, reversed(ground)), 0.0);
  Random random(9);
  for (int i = 0; i < 500; ++i) {
    const test::Rotation rotation = random.rotation();
    const V3d offset = random.in_cube(100.0), shift(random.in(-3, 3), random.in(-3, 3), 0);
    const Polygon a = translated(rotation(ground), offset);
    const Polygon b = translated(rotation(translated(ground, i % 2 ? shift : x)), offset);
    EXPECT_EQ(exchange_exact(a, b), 0.0) << "coplanar";
    EXPECT_EQ(exchange_exact(a, reversed(b)), 0.0) << "coplanar";
  }
}

TEST(Exchange, DegeneratePolygonsExchangeNothing) {
  const V3d corners[] = {V3d(0.0), x, y, z, x + z, V3d(0.5, 0.5, 0.5), V3d(1e-300, 0, 1e-300)};
  for (const V3d& p : corners)
    for (const V3d& q : corners)
      for (const Polygon& flat : {make_polygon(p, q, q), make_polygon(p, p, q), make_polygon(p, q, p, q),
                                  make_polygon(p, (p + q) * 0.5, q)})
        for (double accuracy : {1e-4, 1e-9}) {
          const double value = exchange_exact(ground, flat, accuracy);
          EXPECT_TRUE(value >= 0.0 && value < 1e-15) << value;
          EXPECT_TRUE(exchange_point(ground, flat) >= 0.0);
          EXPECT_EQ(exchange_point(flat, ground), 0.0);
        }
  EXPECT_EQ(exchange_exact(ground, Polygon{}), 0.0);
}

TEST(Exchange, IsFiniteAndBoundedForPolygonsOnACoarseGrid) {
  // Corners from {0, 1, 2}^3, off by an ulp here and there: everything touches, overlaps, crosses or
  // degenerates.
  Random random(10);
  const auto coordinate = [&] {
    const double c = std::floor(random.in(0, 3));
    return random.in(0, 1) < 0.2 ? std::nextafter(c, random.in(-5, 5)) : c;
  };
  for (int i = 0; i < 20000; ++i) {
    Polygon pair[2];
    for (Polygon& p : pair)
      for (p.n = 0; p.n < 3; ++p.n) p.v[p.n] = V3d(coordinate(), coordinate(), coordinate());
    const double value = exchange_exact(pair[0], pair[1], 1e-6);
    const double smaller = std::min(polygon_area(pair[0]), polygon_area(pair[1]));
    ASSERT_TRUE(value >= 0.0 && value <= smaller * (1 + 1e-6) + 1e-13) << value << " of " << smaller;
    if (i % 10 == 0) {
      const Polygon& a = pair[0];
      const V3d middle = (a.v[0] + a.v[1]) * 0.5;
      const double halves = exchange_exact(make_polygon(a.v[0], middle, a.v[2]), pair[1], 1e-6) +
                            exchange_exact(make_polygon(middle, a.v[1], a.v[2]), pair[1], 1e-6);
      ASSERT_NEAR(value, halves, 1e-6 * value + 1e-13);
    }
  }
}

TEST(Exchange, NearlyCoplanarNeighboursKeepAnAbsoluteErrorOfRounding) {
  // Two unit squares with a common edge, folded by a small angle e: F = e^2 / 4 x 0.43... tends to zero; the
  // sum over a cut must agree within rounding of order one.
  for (double e : {1e-2, 1e-4, 1e-6, 1e-8}) {
    const Polygon folded = parallelogram(V3d(0.0), y, V3d(-std::cos(e), 0, std::sin(e)));
    const double value = exchange_exact(ground, folded, 1e-9);
    EXPECT_GE(value, 0.0);
    EXPECT_LT(value, e * e);
    const double halves = exchange_exact(parallelogram(V3d(0.0), x * 0.5, y), folded, 1e-9) +
                          exchange_exact(parallelogram(x * 0.5, x * 0.5, y), folded, 1e-9);
    EXPECT_NEAR(value, halves, 1e-9 * value + 1e-15);
  }
}

TEST(Exchange, AccuraciesBeyondReachAreHarmless) {
  const Polygon ceiling = parallelogram(z * 3, y, x);
  for (double accuracy : {0.0, -1.0, 1e-300, 1.0, 1e300}) {
    const double value = exchange_exact(ground, ceiling, accuracy);
    EXPECT_TRUE(value > 0.01 && value < 0.1) << value;
  }
}

TEST(ExchangePoint, IsTheReceiversAreaTimesLambertAtItsCentroid) {
  const Polygon floor2 = parallelogram(V3d(-0.5, -0.5, 0), x * 2, y * 2);
  const Polygon ceiling = parallelogram(z, y, x);
  EXPECT_RELATIVE(exchange_point(floor2, ceiling), 4.0 * 0.23945647046077354, 1e-15);
  EXPECT_EQ(exchange_point(reversed(floor2), ceiling), 0.0);
}

TEST(ExchangePoint, ConvergesWithTheSquareOfTheDistance) {
  double previous = 1.0;
  for (double distance : {4.0, 8.0, 16.0, 32.0}) {
    const Polygon ceiling = parallelogram(z * distance, y, x);
    const double error = exchange_point(ground, ceiling) / exchange_exact(ground, ceiling, 1e-9) - 1.0;
    EXPECT_GT(error, 0.0);
    if (distance > 4.0) {
      EXPECT_NEAR(error / previous, 0.25, 0.02);
    }
    previous = error;
  }
}

}  // namespace
}  // namespace twopass
