#include "radiosity/hemicube.h"

#include <gtest/gtest.h>

#include "radiosity/form_factor_pair.h"
#include "radiosity/hemicube_pixels.h"
#include "radiosity/lambert.h"
#include "radiosity/solution.h"
#include "radiosity/subdivision.h"
#include "render/core/error.h"
#include "render/core/parallel.h"
#include "tests/radiosity/polygon_samples.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

using test::parallelogram;

ExchangeMatrix exchange_of(const Scene& scene, const ElementMesh& mesh, int resolution,
                           std::uint32_t seed = 0) {
  std::uint64_t rays = 0;
  return hemicube_exchange(scene, mesh, resolution, seed, rays);
}

// Power exchanged between two shapes.
double exchange_of_shapes(const ElementMesh& mesh, const ExchangeMatrix& exchange, std::uint32_t a,
                          std::uint32_t b) {
  double sum = 0.0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    for (ExchangeMatrix::InnerIterator it(exchange, i); it; ++it)
      if (mesh.root(i).shape == a && mesh.root(static_cast<std::uint32_t>(it.col())).shape == b)
        sum += static_cast<double>(it.value());
  return sum;
}

// The square on a face of the cube of half edge 1 that a pixel is, facing the origin.
Polygon pixel_square(const HemicubePixel& pixel, int resolution) {
  const V3d d(pixel.direction);
  const double face = std::max({std::abs(d.x), std::abs(d.y), d.z}), half = 1.0 / resolution;
  const V3d centre = d / face;
  V3d u(half, 0, 0), v(0, half, 0);
  if (std::abs(d.x) == face) u = V3d(0, 0, half);
  if (std::abs(d.y) == face) v = V3d(0, 0, half);
  if (u.cross(v).dot(centre) > 0.0) std::swap(u, v);
  return parallelogram(centre - u - v, u * 2.0, v * 2.0);
}

TEST(Hemicube, PixelsAddUpToOneAndAreTheSquaresThatTheyStandFor) {
  double last_worst = 1.0;
  for (const int resolution : {4, 8, 16, 32, 64}) {
    const std::vector<HemicubePixel> pixels = hemicube_pixels(resolution);
    ASSERT_EQ(pixels.size(), std::size_t(3 * resolution * resolution));
    double sum = 0.0, sum_of_squares = 0.0, worst = 0.0;
    for (const HemicubePixel& pixel : pixels) {
      // (R2): the solid angle of the pixel, projected.
      const double exact = point_form_factor(V3d(0.0), V3d(0, 0, 1), pixel_square(pixel, resolution));
      sum += pixel.weight;
      sum_of_squares += exact;
      worst = std::max(worst, std::abs(pixel.weight / exact - 1.0));
      EXPECT_NEAR(pixel.direction.length(), 1.0, 1e-6);
      EXPECT_GT(pixel.direction.z, 0.0);
    }
    EXPECT_NEAR(sum, 1.0, 1e-13);
    EXPECT_NEAR(sum_of_squares, 1.0, 1e-7);  // they tile the half cube; directions are in single precision
    // The centre stands for its pixel to the second order.
    EXPECT_LT(worst, 3.0 / (resolution * resolution));
    EXPECT_LT(worst, 0.35 * last_worst);
    last_worst = worst;
  }
}

TEST(Hemicube, RefusesWhatIsNoCube) {
  for (const int resolution : {-2, 0, 1, 3, 65, hemicube_max_resolution + 2})
    EXPECT_THROW(hemicube_pixels(resolution), Error) << resolution;
  const Scene scene(test::lit_cube(0.5f));
  EXPECT_THROW(exchange_of(scene, divide_surfaces(scene, 20000), 2), Error);
  EXPECT_THROW(exchange_of(scene, divide_surfaces(scene, 100), 7), Error);
}

// One triangle each: what a hemicube finds is the form factor of the centroid's point to the polygon, as well
// as pixels resolve it.
TEST(Hemicube, SeesWhatThePointSeesToTheResolutionOfThePicture) {
  for (const float distance : {0.2f, 1.0f, 3.0f}) {
    const Scene scene(test::plates(distance, 0.5f));
    const ElementMesh mesh = divide_surfaces(scene, 0);
    ASSERT_EQ(mesh.count(), 4u);
    double last_error = 1.0;
    for (const int resolution : {8, 32, 256}) {
      const ExchangeMatrix exchange = exchange_of(scene, mesh, resolution);
      double error = 0.0;
      for (std::uint32_t i = 0; i < 2; ++i)
        for (std::uint32_t j = 2; j < 4; ++j) {
          const Polygon a = mesh.patch(i).polygon(), b = mesh.patch(j).polygon();
          const double truth = 0.5 * (exchange_point(a, b) + exchange_point(b, a));
          error = std::max(error, std::abs(double(exchange.coeff(i, j)) / truth - 1.0));
        }
      // A polygon of p x p pixels has about p of them on its edges: half of each is a matter of luck, and lucks
      // add up like sqrt(p).
      EXPECT_LT(error, 4.0 / resolution * std::max(1.0f, distance)) << distance << " " << resolution;
      EXPECT_LT(error, last_error);
      last_error = error;
    }
  }
}

// Against the closed forms of squares: the error falls with the elements' size over their distance, and more
// pixels do not help where that is what is left.
TEST(Hemicube, UnitSquaresApproachTheExactExchange) {
  const double parallel = 0.19982489569838738, perpendicular = 0.20004377607540315;
  const Scene scene(test::lit_cube(0.5f));
  const auto error_of = [&](std::size_t elements, int resolution) {
    const ElementMesh mesh = divide_surfaces(scene, elements);
    const ExchangeMatrix exchange = exchange_of(scene, mesh, resolution);
    return std::array{std::abs(exchange_of_shapes(mesh, exchange, 0, 1) - parallel),
                      std::abs(exchange_of_shapes(mesh, exchange, 0, 2) - perpendicular)};
  };
  const auto coarse = error_of(12, 128), pixelated = error_of(200, 4), fine = error_of(200, 48);
  EXPECT_GT(coarse[0], 0.005);
  EXPECT_GT(coarse[1], 0.005);
  for (const int k : {0, 1}) {
    EXPECT_LT(fine[k], 2e-3);
    EXPECT_LT(fine[k], 0.2 * coarse[k]);
    EXPECT_LT(fine[k], pixelated[k]);
  }
}

// What the method cannot do: close to a square, the centroids of two halves of another see far more of it than
// their surroundings do, and no number of pixels helps; and pixels miss what is smaller than they are.
TEST(Hemicube, TakesElementsForPointsAndMissesWhatIsSmallerThanAPixel) {
  const Scene close(test::plates(0.2f, 0.5f));
  const ElementMesh mesh = divide_surfaces(close, 0);
  const V3d x(1, 0, 0), y(0, 1, 0);
  const double exact = exchange_exact(parallelogram(V3d(0.0), x, y), parallelogram(V3d(0, 0, 0.2), y, x), 1e-9);
  for (const int resolution : {64, 256})
    EXPECT_GT(exchange_of_shapes(mesh, exchange_of(close, mesh, resolution), 0, 1), 1.1 * exact);

  const Scene far(test::plates(60.0f, 0.5f));
  const ElementMesh distant = divide_surfaces(far, 0);
  const double truth = exchange_exact(distant.patch(0).polygon(), distant.patch(2).polygon());
  // A pixel of the top covers 60 * 2 / 8 = 15 squares' edges: all or nothing, 225 times too much.
  for (std::uint32_t seed = 0; seed < 4; ++seed) {
    const double seen = exchange_of(far, distant, 8, seed).coeff(0, 2);
    EXPECT_TRUE(seen == 0.0 || seen > 50.0 * truth);
  }
}

TEST(Hemicube, IsSymmetricAndTheSameOnAnyNumberOfThreads) {
  const Scene scene(test::lit_room());
  const ElementMesh mesh = divide_surfaces(scene, 300);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return Eigen::MatrixXf(exchange_of(scene, mesh, 16));
  };
  const Eigen::MatrixXf one = run(1);
  EXPECT_EQ(one, run(2));
  EXPECT_EQ(one, one.transpose());
  EXPECT_NE(one, Eigen::MatrixXf(exchange_of(scene, mesh, 16, 1)));  // turned otherwise
  std::uint64_t rays = 5;
  hemicube_exchange(scene, mesh, 16, 0, rays);
  EXPECT_EQ(rays, 5 + mesh.count() * 3 * 16 * 16);
}

// A carpet right on top of an element's centroid: its own view is worthless, those of the others stand.
TEST(Hemicube, CoveredCentroidsSeeNothing) {
  SceneDescription description = test::plates(1.0f, 0.5f);
  const V3f third(0.6667f, 0.3333f, 0.001f), x(0.02f, 0, 0), y(0, 0.02f, 0);
  test::add_diffuse(description, "carpet", test::quad(third - (x + y) * 0.5f, x, y), C3f(0.0f));
  const Scene scene(std::move(description)), bare(test::plates(1.0f, 0.5f));
  const ElementMesh mesh = divide_surfaces(scene, 0), bare_mesh = divide_surfaces(bare, 0);
  ASSERT_EQ(mesh.count(), 4u);
  const ExchangeMatrix covered = exchange_of(scene, mesh, 64), open = exchange_of(bare, bare_mesh, 64);
  for (std::uint32_t i = 0; i < 2; ++i)
    for (std::uint32_t j = 2; j < 4; ++j) EXPECT_NEAR(covered.coeff(i, j) / open.coeff(i, j), 1.0, 0.15);
}

RadiosityOptions options_for(FormFactorMethod method, std::size_t elements) {
  RadiosityOptions options;
  options.form_factors = method;
  options.max_elements = elements;
  options.relative_error = 1e-6;
  options.hemicube_resolution = 32;
  options.rays_per_element = 256;
  return options;
}

// Sum A B = Sum A E / (1 - rho) in a closed room, whatever the pixels have seen.
TEST(Hemicube, ClosedRoomsConserveEnergy) {
  for (const float rho : {0.5f, 0.9f}) {
    const Scene scene(test::lit_cube(rho));
    const Solution solution = solve_radiosity(scene, options_for(FormFactorMethod::hemicube, 200));
    double irradiance = 0.0;
    for (std::uint32_t i = 0; i < solution.mesh().count(); ++i)
      irradiance += solution.mesh().area(i) * double(solution.irradiances()[i].total().x);
    EXPECT_NEAR(irradiance * (1.0 - double(rho)), 1.0, 2e-6);
  }
}

// 0.3 % rms with 600 elements and 32 x 32 pixels, measured; 1 % here with 300.
TEST(Hemicube, SolvesTheCubeLikeExactFactors) {
  const Scene scene(test::lit_cube(0.7f));
  const Solution exact = solve_radiosity(scene, options_for(FormFactorMethod::exact, 300));
  const Solution hemicube = solve_radiosity(scene, options_for(FormFactorMethod::hemicube, 300));
  EXPECT_EQ(hemicube.stats().form_factors, "hemicube");
  EXPECT_TRUE(hemicube.stats().closed);
  double error = 0.0, mean = 0.0;
  for (std::uint32_t i = 0; i < exact.mesh().count(); ++i) {
    const double truth = double(exact.irradiances()[i].total().x);
    error += exact.mesh().area(i) * std::pow(double(hemicube.irradiances()[i].total().x) - truth, 2);
    mean += exact.mesh().area(i) * truth * truth;
  }
  EXPECT_LT(std::sqrt(error / mean), 0.01);
}

}  // namespace
}  // namespace twopass
