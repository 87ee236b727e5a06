#include "radiosity/analytic_exchange.h"

#include <gtest/gtest.h>

#include "radiosity/enforce.h"
#include "radiosity/subdivision.h"
#include "render/core/error.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

ExchangeMatrix exchange_of(const Scene& scene, const ElementMesh& mesh, FormFactorMethod method) {
  std::uint64_t rays = 0;
  return analytic_exchange(mesh, scene.caster(), method, 0, rays);
}

TEST(AnalyticExchange, RowsOfAnEmptyCubeAddUpToTheAreas) {
  const Scene scene(test::lit_cube(0.5f));
  const ElementMesh mesh = divide_surfaces(scene, 200);
  const ExchangeMatrix exchange = exchange_of(scene, mesh, FormFactorMethod::exact);
  const std::vector<double> sum = row_sums(exchange);
  // exchange_exact is asked for four digits.
  for (std::uint32_t i = 0; i < mesh.count(); ++i) EXPECT_NEAR(sum[i] / mesh.area(i), 1.0, 1e-4);
  const ExchangeMatrix transposed = exchange.transpose();
  EXPECT_EQ(Eigen::MatrixXf(exchange), Eigen::MatrixXf(transposed));
}

TEST(AnalyticExchange, PointsApproximateWhatIsFarApart) {
  const Scene scene(test::lit_cube(0.5f));
  const ElementMesh mesh = divide_surfaces(scene, 400);
  const ExchangeMatrix exact = exchange_of(scene, mesh, FormFactorMethod::exact);
  const ExchangeMatrix point = exchange_of(scene, mesh, FormFactorMethod::point);
  int compared = 0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    for (ExchangeMatrix::InnerIterator it(exact, i); it; ++it) {
      const auto j = static_cast<std::uint32_t>(it.col());
      if ((mesh.patch(i).centroid().position - mesh.patch(j).centroid().position).length() < 0.7) continue;
      EXPECT_NEAR(point.coeff(i, j) / it.value(), 1.0, 0.1);
      ++compared;
    }
  EXPECT_GT(compared, 1000);
}

TEST(AnalyticExchange, InsideOfASphereIsConstantAndCloses) {
  SceneDescription description;
  test::add_diffuse(description, "ball", Sphere{V3f(1.0f), 2.0f, true}, C3f(0.5f), C3f(1.0f));
  const Scene scene(std::move(description));
  const ElementMesh mesh = divide_surfaces(scene, 128);
  const ExchangeMatrix exchange = exchange_of(scene, mesh, FormFactorMethod::exact);
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    EXPECT_NEAR(exchange.coeff(i, 7) / mesh.area(i), mesh.area(7) / (16.0 * pi), 1e-8);
    EXPECT_NEAR(row_sums(exchange)[i] / mesh.area(i), 1.0, 1e-6);
  }
}

TEST(AnalyticExchange, WhatIsHiddenExchangesNothing) {
  SceneDescription description = test::plates(1.0f, 0.5f);
  test::add_box(description, "block", V3f(-1, -1, 0.4f), V3f(2, 2, 0.6f),
                one_sided("block", Diffuse{C3f(0.5f)}));
  const Scene scene(std::move(description));
  const ElementMesh mesh = divide_surfaces(scene, 200);
  const ExchangeMatrix exchange = exchange_of(scene, mesh, FormFactorMethod::exact);
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    for (ExchangeMatrix::InnerIterator it(exchange, i); it; ++it)
      EXPECT_FALSE(mesh.root(i).shape == 0 && mesh.root(static_cast<std::uint32_t>(it.col())).shape == 1);
}

TEST(AnalyticExchange, RefusesWhatWouldTakeForEver) {
  const Scene scene(test::lit_cube(0.5f));
  EXPECT_THROW(exchange_of(scene, divide_surfaces(scene, 20000), FormFactorMethod::exact), Error);
}

}  // namespace
}  // namespace twopass
