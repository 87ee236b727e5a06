#include "radiosity/visible_exchange.h"

#include <chrono>
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

// The exchange between two lists of triangles past a third.
double visible(const std::vector<Polygon>& from, const std::vector<Polygon>& to, const std::vector<Polygon>& screens, double accuracy) {
  std::vector<Polygon> all = from;
  all.insert(all.end(), to.begin(), to.end());
  all.insert(all.end(), screens.begin(), screens.end());
  const Blockers blockers(all);
  double sum = 0.0;
  for (const Polygon& a : from)
    for (const Polygon& b : to) sum += blockers.visible_exchange(a, b, exchange_exact(a, b, 1e-10), accuracy);
  return sum;
}

// What the square [lo, hi]^2 half-way between two unit squares at the distance h intercepts. A pair of points meets it if
// their middle is in it: with the middle and the difference as variables, the middle's part of (R1) is a product of
// lengths and that of the difference a smooth function between the kinks of the lengths.
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

TEST(VisibleExchange, Probe) {
  const Polygon ground = parallelogram(V3d(0.0), x, y);
  for (const double h : {1.0, 0.1})
  for (const auto& [lo, hi] : {std::pair{0.25, 0.75}, {0.4, 0.6}, {0.49, 0.51}, {0.0, 0.3}}) {
    const Polygon ceiling = parallelogram(z * h, y, x);
    const Polygon screen = parallelogram(V3d(lo, lo, h/2), x * (hi - lo), y * (hi - lo));
    const double all = exchange_exact(ground, ceiling, 1e-12), truth = all - intercepted_half_way(lo, hi, h);
    for (double acc : {1e-3, 1e-4, 1e-5}) {
      const auto t0 = std::chrono::steady_clock::now();
      const double v = visible(halves(ground), halves(ceiling), halves(screen), acc);
      const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count();
      std::printf("h %g %g-%g acc %g truth %.8f of %.8f error/all %.2e  %.2f ms\n", h, lo, hi, acc, truth, all, (v - truth) / all, 1e3 * s);
    }
  }
}

}  // namespace
}  // namespace twopass
