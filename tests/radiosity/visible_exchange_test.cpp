#include "radiosity/visible_exchange.h"

#include <gtest/gtest.h>

#include "radiosity/form_factor_pair.h"
#include "tests/radiosity/polygon_samples.h"

namespace twopass {
namespace {

using test::parallelogram;

const V3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);

std::vector<Polygon> halves(const Polygon& q) {
  return {make_polygon(q.v[0], q.v[1], q.v[2]), make_polygon(q.v[0], q.v[2], q.v[3])};
}

// The exchange between two squares in halves, past a third.
double visible(const Polygon& from, const Polygon& to, const Polygon& screen, double accuracy) {
  std::vector<Polygon> all;
  for (const Polygon& square : {from, to, screen})
    for (const Polygon& half : halves(square)) all.push_back(half);
  const Blockers blockers(all);
  double sum = 0.0;
  for (const Polygon& a : halves(from))
    for (const Polygon& b : halves(to))
      sum += blockers.visible_exchange(a, b, exchange_exact(a, b, 1e-10), accuracy);
  return sum;
}

// What the square [lo, hi]^2 half-way between two unit squares at the distance h intercepts. A pair of points
// meets it if their middle is in it: with the middle and the difference as variables, the middle's part of (R1)
// is a product of lengths and that of the difference a smooth function between the kinks of the lengths.
double intercepted_half_way(double lo, double hi, double h) {
  const auto length = [&](double d) {
    return std::max(0.0, std::min(hi, 1 - std::abs(d) / 2) - std::max(lo, std::abs(d) / 2));
  };
  std::vector<double> kinks{-1, 0, 1};
  for (const double k : {2 * lo, 2 * hi, 2 - 2 * hi, 2 - 2 * lo})
    for (const double s : {-1.0, 1.0})
      if (k < 1) kinks.push_back(s * k);
  std::sort(kinks.begin(), kinks.end());
  const GaussRule& rule = gauss_legendre(16);
  std::vector<std::pair<double, double>> nodes;
  for (std::size_t k = 0; k + 1 < kinks.size(); ++k)
    for (int i = 0; i < rule.n; ++i) {
      const double w = kinks[k + 1] - kinks[k], d = kinks[k] + w * rule.x[i];
      nodes.emplace_back(d, w * rule.w[i] * length(d));
    }
  double sum = 0.0;
  for (const auto& [u, wu] : nodes)
    for (const auto& [v, wv] : nodes) {
      const double r2 = u * u + v * v + h * h;
      sum += wu * wv * h * h / (pi * r2 * r2);
    }
  return sum;
}

TEST(VisibleExchange, PastAScreenHalfWay) {
  const Polygon ground = parallelogram(V3d(0.0), x, y);
  for (const double h : {1.0, 0.1})
    for (const auto& [lo, hi] : {std::pair{0.25, 0.75}, {0.4, 0.6}, {0.0, 0.3}, {0.2, 0.95}, {-1.0, 2.0}}) {
      const Polygon ceiling = parallelogram(z * h, y, x);
      const Polygon screen = parallelogram(V3d(lo, lo, h / 2), x * (hi - lo), y * (hi - lo));
      const double all = exchange_exact(ground, ceiling, 1e-12);
      const double truth = lo < 0.0 ? 0.0 : all - intercepted_half_way(lo, hi, h);
      for (const double accuracy : {1e-3, 3e-4})
        EXPECT_NEAR(visible(ground, ceiling, screen, accuracy), truth, accuracy * all) << h << " " << lo;
      // Turned over and as one quadrilateral, it hides the same.
      const Blockers whole({test::reversed(screen)});
      EXPECT_NEAR(whole.visible_exchange(ground, ceiling, all, 1e-4), truth, 1e-4 * all) << h << " " << lo;
    }
}

// A screen of four ten-thousandths of the area is not overlooked.
TEST(VisibleExchange, PastASmallScreen) {
  const Polygon ground = parallelogram(V3d(0.0), x, y), ceiling = parallelogram(z, y, x);
  const Polygon screen = parallelogram(V3d(0.49, 0.49, 0.5), x * 0.02, y * 0.02);
  const double all = exchange_exact(ground, ceiling, 1e-12);
  EXPECT_RELATIVE(all - visible(ground, ceiling, screen, 1e-6), intercepted_half_way(0.49, 0.51, 1.0), 0.01);
}

// What one sees of the other changes at once at the wall's foot.
TEST(VisibleExchange, PastAWallThatTouchesBoth) {
  const Polygon ground = parallelogram(V3d(0.0), x, y), ceiling = parallelogram(z, y, x);
  // The wall x = 1/2 leaves each half of the ground with the half of the ceiling above it.
  const Polygon wall = parallelogram(V3d(0.5, 0, 0), y, z);
  const double half[2] = {0.0, 0.5}, whole[2] = {0.0, 1.0};
  const double truth = 2.0 * test::parallel_rectangles(half, whole, half, whole, 1.0);
  const double all = exchange_exact(ground, ceiling, 1e-12);
  EXPECT_NEAR(visible(ground, ceiling, wall, 1e-4), truth, 1e-4 * all);
  EXPECT_NEAR(Blockers({wall}).visible_exchange(ground, ceiling, all, 1e-4), truth, 1e-5 * all);
}

TEST(VisibleExchange, WhatOnlyTouchesHidesNothing) {
  std::vector<Polygon> room;
  const Polygon faces[] = {parallelogram(V3d(0.0), x, y), parallelogram(z, y, x),
                           parallelogram(V3d(0.0), y, z), parallelogram(x, z, y),
                           parallelogram(V3d(0.0), z, x), parallelogram(y, x, z)};
  for (const Polygon& face : faces)
    for (const Polygon& half : halves(face)) room.push_back(half);
  room.push_back(parallelogram(V3d(0.2, 0.2, 0), x * 0.1, y * 0.1));     // lies on the floor
  room.push_back(parallelogram(V3d(0.2, 0.2, -0.5), x * 0.1, y * 0.1));  // below it
  const Blockers blockers(room);
  for (const Polygon& a : room)
    for (const Polygon& b : room) {
      if (&a == &b) continue;
      const double all = exchange_exact(a, b, 1e-10);
      if (all > 0.0 && a.v[0].z >= 0.0 && b.v[0].z >= 0.0) {
        EXPECT_TRUE(blockers.none_between(a, b));
        EXPECT_EQ(blockers.visible_exchange(a, b, all, 1e-4), all);
      }
    }
}

TEST(VisibleExchange, TrianglesJoinOnlyIntoFlatConvexQuadrilaterals) {
  const Polygon square = parallelogram(V3d(0.0), x, y);
  ASSERT_EQ(join_triangles(halves(square)).size(), 1u);
  EXPECT_EQ(join_triangles(halves(square))[0].n, 4);
  EXPECT_NEAR(polygon_area_vector(join_triangles(halves(square))[0]).z, 1.0, 1e-15);
  const Polygon bent = make_polygon(V3d(0.0), x, x + y + z * 1e-3, y);
  EXPECT_EQ(join_triangles(halves(bent)).size(), 2u);
  const Polygon arrow = make_polygon(V3d(0.0), V3d(1, 0.5, 0), V3d(0.2, 0.5, 0), V3d(0, 1, 0));
  EXPECT_EQ(join_triangles(halves(arrow)).size(), 2u);
  const std::vector<Polygon> turned{halves(square)[0], test::reversed(halves(square)[1])};
  EXPECT_EQ(join_triangles(turned).size(), 2u);
}

}  // namespace
}  // namespace twopass
