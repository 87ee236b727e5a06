#include "radiosity/guide.h"

#include <gtest/gtest.h>

#include "render/core/parallel.h"
#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "tests/radiosity/test_scenes.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

Solution solve_coarsely(const Scene& scene, std::size_t elements = 1500) {
  RadiosityOptions options;
  options.max_elements = elements;
  options.rays_per_element = 64;
  return solve_radiosity(scene, options);
}

// The point that a ray meets.
SurfacePoint seen(const Scene& scene, const V3f& from, const V3f& direction) {
  const Ray ray{from, unit(direction)};
  return scene.surface_point(ray, scene.caster().intersect(ray));
}

// Points on flat surfaces of several orientations, and on a sphere.
struct Places {
  Scene scene;
  Solution solution;
  Guide guide;
  std::vector<SurfacePoint> points;

  explicit Places(SceneDescription description)
      : scene(std::move(description)), solution(solve_coarsely(scene)), guide(scene, solution) {
    for (const V3f& direction : {V3f(0, 0.2f, -1), V3f(0, 0.2f, 1), V3f(1, 0.1f, 0), V3f(-1, 0.1f, 0.3f),
                                 V3f(0.3f, 1, 0.1f), V3f(0.21f, 0.5f, -0.31f)})
      points.push_back(seen(scene, V3f(0.5f, 0.1f, 0.7f), direction));
  }
};

SceneDescription room_around_a_ball() {
  SceneDescription scene = test::lit_room();
  test::add_diffuse(scene, "ball", Sphere{V3f(0.7f, 0.6f, 0.4f), 0.15f, false}, C3f(0.5f));
  return scene;
}

// A quadrature over the disc below the hemisphere, where the density is d = p pi / cosine.
double integral(const Guide::Lobe& lobe, const V3f& normal) {
  constexpr int steps = 288;  // a multiple of the bins
  const Frame frame(normal);
  double sum = 0.0;
  for (int i = 0; i < steps; ++i)
    for (int k = 0; k < steps; ++k) {
      const V2f u((static_cast<float>(i) + 0.5f) / steps, (static_cast<float>(k) + 0.5f) / steps);
      const V3f local = square_to_cosine_hemisphere(u);
      sum += lobe.pdf_w(frame.to_world(local)) / cosine_hemisphere_pdf_w(local.z);
    }
  return sum / (steps * steps);
}

TEST(Guide, DensitiesIntegrateToOne) {
  const Places places(room_around_a_ball());
  for (const SurfacePoint& point : places.points) {
    const Guide::Lobe lobe = places.guide.at(point);
    ASSERT_FALSE(lobe.empty());
    // The frame of the quadrature is turned against that of the histogram, so that edges of bins are crossed.
    EXPECT_NEAR(integral(lobe, point.geometric_normal), 1.0, 3e-3);
    EXPECT_EQ(lobe.pdf_w(-point.geometric_normal), 0.0f);
  }
}

TEST(Guide, SamplesFollowTheDensity) {
  const Places places(room_around_a_ball());
  constexpr int n = 200000, cells = 16;
  for (std::size_t i = 0; i < places.points.size(); ++i) {
    const V3f normal = places.points[i].geometric_normal;
    const Guide::Lobe lobe = places.guide.at(places.points[i]);
    const Frame frame(normal);
    // Counts over the disc below the hemisphere, in a frame that is not the histogram's.
    std::vector<double> observed(cells * cells, 0.0), expected(cells * cells, 0.0);
    const auto cell = [&](const V3f& w) {
      const V3f local = frame.to_local(w);
      const auto at = [](float x) {
        return std::clamp(static_cast<int>((x + 1.0f) * 0.5f * cells), 0, cells - 1);
      };
      return static_cast<std::size_t>(at(local.y) * cells + at(local.x));
    };
    Sampler sampler(7, static_cast<std::uint32_t>(i), 0, SamplerKind::independent);
    for (int k = 0; k < n; ++k) {
      const Guide::Lobe::Direction drawn = lobe.sample(sampler.next_2d());
      ASSERT_NEAR(drawn.direction.length(), 1.0f, 1e-5f);
      ASSERT_GE(drawn.direction.dot(normal), -1e-6f);
      observed[cell(drawn.direction)] += 1.0;
    }
    constexpr int fine = 1024;
    for (int a = 0; a < fine; ++a)
      for (int b = 0; b < fine; ++b) {
        const V2f u((static_cast<float>(a) + 0.5f) / fine, (static_cast<float>(b) + 0.5f) / fine);
        const V3f w = frame.to_world(square_to_cosine_hemisphere(u));
        expected[cell(w)] += n * lobe.pdf_w(w) / cosine_hemisphere_pdf_w(w.dot(normal)) / (double{fine} * fine);
      }
    // Level 1e-4 for all points together.
    EXPECT_GT(test::chi2_test(observed, expected), test::sidak(1e-4, places.points.size())) << "point " << i;
  }
}

TEST(Guide, TellsTheDensityOfWhatItDraws) {
  const Places places(room_around_a_ball());
  for (const SurfacePoint& point : places.points) {
    const Guide::Lobe lobe = places.guide.at(point);
    Sampler sampler(8, 0, 0, SamplerKind::independent);
    int different = 0;
    for (int k = 0; k < 20000; ++k) {
      const Guide::Lobe::Direction drawn = lobe.sample(sampler.next_2d());
      const float again = lobe.pdf_w(drawn.direction);
      // Rounding may put a direction on the other side of a bin's edge, and cosines near 0 have few digits.
      if (std::abs(again - drawn.pdf_w) > 1e-3f * drawn.pdf_w) ++different;
      // At least half the even part: shares of less than two units within a row may be rounded to one.
      ASSERT_GE(drawn.pdf_w, 0.049f * cosine_hemisphere_pdf_w(drawn.direction.dot(point.geometric_normal)));
    }
    EXPECT_LT(different, 20);
  }
}

// A lamp that shines at the ceiling alone: that is where the floor's light comes from.
TEST(Guide, PointsAtTheBrightSurface) {
  SceneDescription description = test::unit_room(C3f(0.3f), C3f(0.0f), C3f(0.8f));
  test::add_diffuse(description, "lamp", test::quad(V3f(0.4f, 0.4f, 0.8f), V3f(0.2f, 0, 0), V3f(0, 0.2f, 0)),
                    C3f(0.3f), C3f(10.0f));
  const Scene scene(std::move(description));
  const Solution solution = solve_coarsely(scene);
  const Guide guide(scene, solution);
  const SurfacePoint floor = seen(scene, V3f(0.1f, 0.1f, 0.5f), V3f(0, 0, -1));
  const Guide::Lobe lobe = guide.at(floor);
  const V3f to_bright = unit(V3f(0.45f, 0.3f, 1.0f) - floor.position), away = unit(V3f(-0.9f, -0.1f, 0.4f));
  const auto relative = [&](const V3f& w) { return lobe.pdf_w(w) / cosine_hemisphere_pdf_w(w.z); };
  EXPECT_GT(relative(to_bright), 1.5f);
  EXPECT_LT(relative(away), 0.8f);
}

// A bright patch of half a bin: of 400 places 244 would miss it with their cells' own rays alone, 119 do.
TEST(Guide, FewPlacesMissASmallBrightPatch) {
  const Scene scene(test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f)));
  Solution dark = solve(scene, 3000);
  const std::uint32_t bright = dark.mesh().find(seen(scene, V3f(0.5f), V3f(0.3f, 0.5f, 0.2f)));
  std::vector<Irradiance> irradiance(dark.mesh().count(), Irradiance{C3f(0.01f), C3f(0.0f)});
  irradiance[bright].direct = C3f(100.0f);
  const V3f target(dark.mesh().centroid(bright).position);
  const Solution solution(dark.mesh(), std::move(irradiance), dark.stats());
  const Guide guide(scene, solution, {.cell_size = 0.1f});
  std::uint32_t missed = 0;
  constexpr std::uint32_t places = 400;
  for (std::uint32_t k = 0; k < places; ++k) {
    const V2f u = Sampler(3, k, 0).next_2d();
    const SurfacePoint floor = seen(scene, V3f(0.02f + 0.96f * u.x, 0.02f + 0.6f * u.y, 0.5f), V3f(0, 0, -1));
    const V3f direction = unit(target - floor.position);
    missed += guide.at(floor).pdf_w(direction) < 2.0f * cosine_hemisphere_pdf_w(direction.z);
  }
  EXPECT_LT(missed, 180u);
}

// What mirrors show counts as what they show; emission behind them, too, for nothing else samples it.
TEST(Guide, SeesThroughMirrors) {
  SceneDescription description;
  test::add_diffuse(description, "floor", test::quad(V3f(-1, -1, 0), V3f(2, 0, 0), V3f(0, 2, 0)), C3f(0.5f));
  test::add_diffuse(description, "mirror", test::quad(V3f(-1, -1, 1), V3f(0, 2, 0), V3f(2, 0, 0)), C3f(0.0f));
  description.materials.back() = one_sided("mirror", Conductor{});
  test::add_diffuse(description, "lamp", test::quad(V3f(-0.1f, -0.1f, 0.5f), V3f(0.2f, 0, 0), V3f(0, 0.2f, 0)),
                    C3f(0.0f), C3f(10.0f));
  const Scene scene(std::move(description));
  const Solution solution = solve_coarsely(scene);
  const Guide guide(scene, solution, {.cell_size = 0.1f, .rays_per_bin = 64});
  const SurfacePoint floor = seen(scene, V3f(0.6f, 0.0f, 0.5f), V3f(0, 0, -1));
  const Guide::Lobe lobe = guide.at(floor);
  ASSERT_FALSE(lobe.empty());
  const V3f to_image = unit(V3f(0, 0, 1.5f) - floor.position);
  EXPECT_GT(lobe.pdf_w(to_image), 3.0f * cosine_hemisphere_pdf_w(to_image.z));
}

TEST(Guide, IsEmptyWhereNoLightArrivesOrNothingReflects) {
  SceneDescription description = test::lit_room();
  const float far = 10.0f;  // a floor in the dark, and a black one
  test::add_diffuse(description, "dark", test::quad(V3f(far, 0, 0), V3f(1, 0, 0), V3f(0, 1, 0)), C3f(0.5f));
  test::add_diffuse(description, "black", test::quad(V3f(far, 2, 0), V3f(1, 0, 0), V3f(0, 1, 0)), C3f(0.0f));
  const Scene scene(std::move(description));
  const Solution solution = solve_coarsely(scene);
  const Guide guide(scene, solution);
  EXPECT_TRUE(guide.at(seen(scene, V3f(far + 0.5f, 0.5f, 1), V3f(0, 0, -1))).empty());
  EXPECT_TRUE(guide.at(seen(scene, V3f(far + 0.5f, 2.5f, 1), V3f(0, 0, -1))).empty());
}

TEST(Guide, IsTheSameOnAnyNumberOfThreads) {
  const Scene scene(room_around_a_ball());
  const Solution solution = solve_coarsely(scene);
  const Places places(room_around_a_ball());
  std::vector<std::vector<float>> densities;
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    const Guide guide(scene, solution);
    densities.emplace_back();
    for (const SurfacePoint& point : places.points)
      for (std::uint32_t k = 0; k < 200; ++k)
        densities.back().push_back(guide.at(point).sample(Sampler(1, k, 0).next_2d()).pdf_w);
  }
  EXPECT_EQ(densities[0], densities[1]);
}

// Where nobody asks there is no guide.
TEST(Guide, IsMadeOnlyWhereItIsWanted) {
  const Scene scene(room_around_a_ball());
  const Solution solution = solve_coarsely(scene);
  GuideOptions options;
  options.wanted.assign(solution.mesh().count(), false);
  const Guide all(scene, solution), none(scene, solution, options);
  EXPECT_EQ(none.rays(), 0u);
  const Places places(room_around_a_ball());
  const SurfacePoint& point = places.points.front();
  options.wanted[solution.mesh().find(point)] = true;
  const Guide one(scene, solution, options);
  EXPECT_GT(one.rays(), 0u);
  EXPECT_LT(one.rays(), all.rays() / 4);
  EXPECT_TRUE(none.at(point).empty());
  ASSERT_FALSE(one.at(point).empty());
  EXPECT_NEAR(integral(one.at(point), point.geometric_normal), 1.0, 3e-3);
}

TEST(Guide, HasNoMoreCellsThanAllowed) {
  const Scene scene(room_around_a_ball());
  const Solution solution = solve_coarsely(scene);
  EXPECT_LE(Guide(scene, solution, {.max_cells = 50, .rays_per_bin = 1}).cell_count(), 50u);
}

}  // namespace
}  // namespace twopass
