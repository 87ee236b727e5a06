#include "radiosity/adaptive.h"

#include <gtest/gtest.h>

#include "radiosity/solution.h"
#include "radiosity/subdivision.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

// A floor under a small lamp, a part of it in the shadow of a screen.
SceneDescription shadowed_floor() {
  SceneDescription scene;
  const V3f x(1, 0, 0), y(0, 1, 0);
  test::add_diffuse(scene, "floor", test::quad(V3f(0.0f), x, y), C3f(0.5f));
  test::add_diffuse(scene, "screen", test::quad(V3f(0.47f, -1, 0.4f), x, y * 3.0f), C3f(0.0f));
  test::add_diffuse(scene, "lamp", test::quad(V3f(0.49f, 0.49f, 0.8f), y * 0.02f, x * 0.02f), C3f(0.0f),
                    C3f(100.0f));
  return scene;
}

RadiosityOptions adaptive(std::size_t elements) {
  RadiosityOptions options;
  options.subdivision = Subdivision::adaptive;
  options.max_elements = elements;
  options.form_factors = FormFactorMethod::exact;
  return options;
}

TEST(Adaptive, AShadowBoundaryCostsElementsAndADarkFloorDoesNot) {
  const Scene scene(shadowed_floor());
  const Solution solution = solve_radiosity(scene, adaptive(2000));
  const ElementMesh& mesh = solution.mesh();
  EXPECT_GT(mesh.count(), 1000u);
  EXPECT_LE(mesh.count(), 2000u);
  double smallest_at_edge = infinity_f, smallest_in_shadow = infinity_f;
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    const double x = mesh.centroid(i).position.x;
    if (std::abs(x - 0.45) < 0.04) smallest_at_edge = std::min(smallest_at_edge, mesh.area(i));
    if (x > 0.75) smallest_in_shadow = std::min(smallest_in_shadow, mesh.area(i));
  }
  EXPECT_LT(smallest_at_edge, smallest_in_shadow / 15.0);
}

// Closer to the truth with as many elements: the irradiance behind and before the edge of the shadow is known.
TEST(Adaptive, BeatsUniformElementsAtAShadow) {
  const Scene scene(shadowed_floor());
  const auto error = [&](const Solution& solution, const Solution& truth) {
    double sum = 0.0, total = 0.0;
    for (std::uint32_t k = 0; k < 4000; ++k) {
      const V2f u = Sampler(3, k, 0).next_2d();
      const Ray ray{V3f(u.x, u.y, 0.1f), V3f(0, 0, -1)};
      const SurfacePoint point = scene.surface_point(ray, scene.caster().intersect(ray));
      const double right = static_cast<double>(truth.irradiance(point).total().x);
      sum += std::abs(static_cast<double>(solution.irradiance(point).total().x) - right);
      total += right;
    }
    return sum / total;
  };
  RadiosityOptions uniform = adaptive(0);
  uniform.form_factors = FormFactorMethod::rays;
  uniform.max_elements = 100000;
  uniform.subdivision = Subdivision::uniform;
  const Solution truth = solve_radiosity(scene, uniform);
  RadiosityOptions refined = uniform;
  uniform.max_elements = refined.max_elements = 3000;
  refined.subdivision = Subdivision::adaptive;
  const double by_uniform = error(solve_radiosity(scene, uniform), truth);
  const double by_adaptive = error(solve_radiosity(scene, refined), truth);
  EXPECT_LT(by_adaptive, 0.8 * by_uniform) << by_uniform;
}

TEST(Adaptive, EvenLightIsNotRefined) {
  // The furnace: the same irradiance everywhere, whatever the elements.
  const Scene scene(test::furnace_room(C3f(0.5f), 1.0f));
  const Solution solution = solve_radiosity(scene, adaptive(2000));
  EXPECT_LE(solution.mesh().count(), 2000u / 8);
}

TEST(Adaptive, ChoosesTheWorstFirstAndNoMoreThanAllowed) {
  const Scene scene(test::lit_room());
  const ElementMesh mesh = divide_surfaces(scene, 500);
  std::vector<Irradiance> irradiance(mesh.count());
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    irradiance[i].direct = C3f(static_cast<float>(std::exp(8.0 * mesh.centroid(i).position.x)));
  const std::vector<double> power = misplaced_power(mesh, irradiance);
  const std::vector<bool> chosen = elements_to_split(mesh, irradiance, {}, 40, 0.0);
  EXPECT_EQ(std::count(chosen.begin(), chosen.end(), true), 40);
  double worst_left = 0.0, least_chosen = infinity_f;
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    chosen[i] ? least_chosen = std::min(least_chosen, power[i]) : worst_left = std::max(worst_left, power[i]);
  EXPECT_GE(least_chosen, worst_left);
  const std::vector<bool> none = elements_to_split(mesh, irradiance, {}, 40, 1e9);
  EXPECT_EQ(std::count(none.begin(), none.end(), true), 0);
}

// A twentieth of what is read of one shape is wrong; what single reads say scatters by twenty times as much, so
// that no element can be told from its neighbours, but all together can.
TEST(Adaptive, GuiltIsWhereErrorsAreMoreThanChance) {
  const Scene scene(test::lit_room());
  const ElementMesh mesh = divide_surfaces(scene, 2000);
  std::vector<Irradiance> irradiance(mesh.count());
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    irradiance[i].direct = C3f(static_cast<float>(1.0 + mesh.centroid(i).position.x));
  const std::uint32_t guilty = mesh.root(0).shape;
  struct Guilt {
    double of_guilty = 0.0, of_others = 0.0;  // of the mean element
  };
  const auto guilt_by = [&](double bias) {
    constexpr std::uint32_t reads = 8;
    std::vector<ElementError> errors(mesh.count());
    for (std::uint32_t i = 0; i < mesh.count(); ++i)
      for (std::uint32_t k = 0; k < reads; ++k) {
        const double noise = 2.0 * static_cast<double>(Sampler(1, i, k).next_1d()) - 1.0;
        errors[i].add(1.0, (mesh.root(i).shape == guilty ? bias : 0.0) + noise);
      }
    const std::vector<double> guilt = guilt_of(mesh, irradiance, errors);
    Guilt sum;
    double guilty_elements = 0.0, others = 0.0;
    for (std::uint32_t i = 0; i < mesh.count(); ++i) {
      const bool is_guilty = mesh.root(i).shape == guilty;
      (is_guilty ? sum.of_guilty : sum.of_others) += guilt[i];
      (is_guilty ? guilty_elements : others) += 1.0;
    }
    return Guilt{sum.of_guilty / guilty_elements, sum.of_others / others};
  };
  const Guilt found = guilt_by(0.05), chance = guilt_by(0.0);
  EXPECT_GT(found.of_guilty, 4.0 * found.of_others);
  EXPECT_GT(found.of_guilty, 4.0 * chance.of_guilty);
}

TEST(Adaptive, TheGuiltiestAreCutMostOftenUntilItIsEnough) {
  std::vector<double> guilt(100, 1e-4);
  guilt[17] = 1.0;
  guilt[42] = 0.1;
  const auto count = [](const std::vector<std::uint8_t>& cuts) {
    std::size_t sum = 0;
    for (const std::uint8_t times : cuts) sum += std::size_t{1} << (2 * times);
    return sum;
  };
  const auto left = [&](const std::vector<std::uint8_t>& cuts) {
    double sum = 0.0;
    for (std::size_t i = 0; i < cuts.size(); ++i) sum += std::ldexp(guilt[i], -cuts[i]);
    return sum;
  };
  const std::vector<std::uint8_t> some = cuts_for(guilt, 0.35, 100000);
  EXPECT_LE(left(some), 0.35);
  EXPECT_EQ(some[17], 2);
  EXPECT_LE(some[42], 1);
  EXPECT_EQ(some[0], 0);
  EXPECT_LT(count(some), 150u);
  // As far as elements reach: the more there may be, the less is left.
  double before = infinity_f;
  for (const std::size_t most : {110u, 200u, 500u, 3000u}) {
    const std::vector<std::uint8_t> cuts = cuts_for(guilt, 0.0, most);
    EXPECT_LE(count(cuts), most);
    EXPECT_LT(left(cuts), before);
    before = left(cuts);
  }
  for (const std::uint8_t times : cuts_for(std::vector<double>(5, 0.0), 0.0, 100)) EXPECT_EQ(times, 0);
}

// Each element in as many parts as its cuts say, in the same order, and all of them found where they are.
TEST(Adaptive, ElementsAreCutAsOftenAsIsAsked) {
  const Scene scene(test::lit_room());
  const ElementMesh mesh = divide_surfaces(scene, 300);
  std::vector<std::uint8_t> times(mesh.count());
  for (std::uint32_t i = 0; i < mesh.count(); ++i) times[i] = static_cast<std::uint8_t>(i % 4);
  const ElementMesh finer = mesh.cut(times);
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    for (std::uint32_t k = 0; k < 1u << (2 * times[i]); ++k, ++next)
      EXPECT_NEAR(finer.whole_area(next), std::ldexp(mesh.whole_area(i), -2 * times[i]), 1e-6);
  ASSERT_EQ(next, finer.count());
  for (std::uint32_t i = 0; i < finer.count(); ++i) {
    const V3f at = finer.centroid(i).ray_position();
    const V3f normal(finer.centroid(i).normal);
    const Ray ray{at + normal * 1e-4f, -normal};
    EXPECT_EQ(finer.find(scene.surface_point(ray, scene.caster().intersect(ray))), i);
  }
}

TEST(Adaptive, IsTheSameOnAnyNumberOfThreadsAndWithinItsBudget) {
  const Scene scene(test::lit_room());
  RadiosityOptions options = adaptive(1500);
  options.form_factors = FormFactorMethod::rays;
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return solve_radiosity(scene, options);
  };
  const Solution one = run(1), two = run(2);
  ASSERT_EQ(one.mesh().count(), two.mesh().count());
  EXPECT_LE(one.mesh().count(), 1500u);
  for (std::uint32_t i = 0; i < one.mesh().count(); ++i)
    EXPECT_EQ(one.irradiances()[i].total(), two.irradiances()[i].total());
}

}  // namespace
}  // namespace twopass
