// Whatever the solution says, the mean is that of the path tracer.
#include "integrators/unbiased.h"

#include <map>

#include <gtest/gtest.h>

#include "integrators/guided_directions.h"
#include "integrators/path.h"
#include "radiosity/guide.h"
#include "render/core/warp.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

// A small lamp, hidden from most of the room by a shelf below it, so that much of the light is indirect; a
// textured floor and a pane that is seen from both sides.
SceneDescription room() {
  SceneDescription scene = test::unit_room(C3f(0.7f, 0.6f, 0.5f), C3f(0.0f), C3f(0.8f));
  test::add_diffuse(scene, "lamp", test::quad(V3f(0.4f, 0.4f, 0.98f), V3f(0, 0.2f, 0), V3f(0.2f, 0, 0)),
                    C3f(0.0f), C3f(20.0f));
  test::add_box(scene, "shelf", V3f(0.25f, 0.25f, 0.85f), V3f(0.75f, 0.75f, 0.9f),
                one_sided("shelf", Diffuse{C3f(0.6f)}));
  const Diffuse sheet{C3f(0.2f, 0.5f, 0.8f)};
  test::add_diffuse(scene, "sheet", test::quad(V3f(0.2f, 0.6f, 0), V3f(0.5f, 0.1f, 0), V3f(0, 0.05f, 0.5f)),
                    C3f(0.0f));
  scene.materials.back() = two_sided("sheet", sheet, sheet);
  return scene;
}

// Mirror, glass, plastic, an open side with sky and a point light.
SceneDescription mixed_room() {
  SceneDescription scene = room();
  scene.shapes.erase(scene.shapes.begin() + 4);  // near
  scene.environment = Environment(C3f(0.1f, 0.2f, 0.4f));
  scene.punctual_lights.push_back(PointLight{V3f(0.8f, 0.2f, 0.7f), C3f(0.05f)});
  test::add_box(scene, "mirror", V3f(0.75f, 0.6f, 0.0f), V3f(0.95f, 0.9f, 0.5f),
                one_sided("mirror", Conductor{}));
  test::add_diffuse(scene, "glass", Sphere{V3f(0.3f, 0.3f, 0.2f), 0.15f, false}, C3f(0.0f));
  scene.materials.back() = interface_material("glass", Dielectric{});
  test::add_box(scene, "plastic", V3f(0.55f, 0.2f, 0.0f), V3f(0.7f, 0.4f, 0.3f),
                one_sided("plastic", Plastic{.base_reflectance = C3f(0.6f)}));
  // Interpolated normals: a bent mesh.
  Mesh bent = test::quad(V3f(0.05f, 0.5f, 0.3f), V3f(0.15f, 0, 0), V3f(0, 0.1f, 0.2f));
  bent.normals = {unit(V3f(-1, -2, 0)), unit(V3f(1, -2, 0)), unit(V3f(1, -2, 1)), unit(V3f(-1, -2, 1))};
  test::add_diffuse(scene, "bent", bent, C3f(0.5f));
  return scene;
}

// Floor and walls under rough coats, which reflect beside diffusing.
SceneDescription room_under_coats() {
  SceneDescription scene = room();
  RoughPlastic coated;
  coated.base_reflectance = C3f(0.7f, 0.6f, 0.5f);
  coated.prepare();
  for (const std::size_t wall : {0, 2, 3, 5}) scene.materials[wall] = one_sided("coated", coated);
  return scene;
}

enum class Content { solved, scaled, random, dark, nothing };

// A solution of the scene with its irradiances replaced.
Solution make_solution(const Scene& scene, Content content) {
  RadiosityOptions options;
  options.max_elements = 1000;
  options.rays_per_element = 64;
  Solution solved = solve_radiosity(scene, options);
  std::vector<Irradiance> irradiance(solved.irradiances().begin(), solved.irradiances().end());
  Sampler sampler(99, 0, 0, SamplerKind::independent);
  for (Irradiance& h : irradiance) {
    if (content == Content::scaled) h = {h.direct * 10.0f, h.indirect * 10.0f};
    // Over two decades, each channel for itself.
    const auto any = [&] { return std::pow(10.0f, 2.0f * sampler.next_1d() - 1.0f); };
    if (content == Content::random) h = {C3f(any(), any(), any()), C3f(any(), any(), any())};
    if (content == Content::dark) h = {};
  }
  return Solution(solved.mesh(), std::move(irradiance), solved.stats());
}

struct Case {
  std::string name;
  SceneDescription (*scene)();
  Content content;
  bool guided;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

const V3f eye(0.5f, 0.06f, 0.5f);
const V3f views[] = {V3f(0, 1, -0.3f), V3f(0.4f, 1, -0.6f), V3f(-0.3f, 1, 0.5f)};

std::vector<Case> cases() {
  return {{"solved", room, Content::solved, true},
          {"solved_unguided", room, Content::solved, false},
          {"ten_times_too_bright", room, Content::scaled, true},
          {"random", room, Content::random, true},
          {"dark", room, Content::dark, true},
          {"nothing", room, Content::nothing, false},
          {"coated_solved", room_under_coats, Content::solved, true},
          {"coated_random", room_under_coats, Content::random, true},
          {"mixed_solved", mixed_room, Content::solved, true},
          {"mixed_random", mixed_room, Content::random, true},
          {"mixed_dark", mixed_room, Content::dark, true}};
}

// What the path tracer sees, found once a scene and view.
const test::Estimate& truth_of(SceneDescription (*description)(), const Scene& scene, std::size_t view) {
  static std::map<std::pair<SceneDescription (*)(), std::size_t>, test::Estimate> found;
  const auto [place, is_new] = found.try_emplace({description, view});
  if (is_new)
    place->second = test::mean_radiance(PathTracer(scene, {}), eye, views[view], 0.8f, 120000,
                                        20 + static_cast<std::uint32_t>(view));
  return place->second;
}

class UnbiasedTest : public testing::TestWithParam<Case> {};

TEST_P(UnbiasedTest, HasTheMeanOfThePathTracer) {
  const Case& c = GetParam();
  const Scene scene(c.scene());
  std::optional<Solution> solution;
  if (c.content != Content::nothing) solution.emplace(make_solution(scene, c.content));
  std::optional<Guide> guide;
  if (c.guided) guide.emplace(scene, *solution);
  const Unbiased unbiased(scene, {solution ? &*solution : nullptr, nullptr, guide ? &*guide : nullptr}, {});
  for (std::size_t k = 0; k < std::size(views); ++k) {
    const test::Estimate ours =
        test::mean_radiance(unbiased, eye, views[k], 0.8f, 60000, 10 + static_cast<std::uint32_t>(k));
    const test::Estimate& truth = truth_of(c.scene, scene, k);
    EXPECT_LT(truth.standard_error(), 0.03 * truth.mean());
    // Noise grows with the error of the content, and so would what is wrongly kept of it.
    EXPECT_LT(ours.standard_error(), 0.3 * truth.mean());
    // Level 1e-4 for all cases and views together.
    const double z = test::z_score(ours, truth);
    EXPECT_GT(test::two_sided_p(z), test::sidak(1e-4, std::size(views) * cases().size()))
        << "view " << k << ": " << ours.mean() << " +- " << ours.standard_error() << " against " << truth.mean()
        << " +- " << truth.standard_error();
  }
}

INSTANTIATE_TEST_SUITE_P(Contents, UnbiasedTest, testing::ValuesIn(cases()),
                         [](const auto& content) { return content.param.name; });

// With an infinite variance the variance of means of 4 n samples would not fall to a quarter of that of n.
TEST(Unbiased, HasAFiniteVariance) {
  const Scene scene(room());
  for (const Content content : {Content::solved, Content::random, Content::dark}) {
    const Solution solution = make_solution(scene, content);
    const Guide guide(scene, solution);
    const Unbiased unbiased(scene, {&solution, nullptr, &guide}, {});
    // Four batches, each four times the last: the variance of a sample must not grow. A constant probability
    // of survival has it grow a hundredfold; rare bright samples, which the first batch may not have met, by
    // 3.1 at most of 3 contents. Ten lies half way.
    std::vector<double> variance;
    for (int batch = 0, n = 3000; batch < 4; ++batch, n *= 4)
      variance.push_back(
          test::mean_radiance(unbiased, eye, V3f(0, 1, -0.3f), 0.8f, n, static_cast<std::uint32_t>(30 + batch))
              .variance());
    for (std::size_t k = 1; k < variance.size(); ++k) EXPECT_LT(variance[k], 10.0 * variance[0]);
  }
}

// The largest random number below 1 leads to the horizon, where rounding decides whether the model sees it.
TEST(Unbiased, GuidedDirectionsOnTheHorizonAreFinite) {
  const Scene scene(room());
  const Solution solution = make_solution(scene, Content::solved);
  const Guide guide(scene, solution);
  const Bsdf bsdf = Diffuse{C3f(0.5f)};
  int on_the_horizon = 0;
  for (std::uint32_t k = 0; k < 4000; ++k) {
    Sampler sampler(5, k, 0);
    const V2f u = sampler.next_2d();
    const V3f normal = square_to_sphere(u);
    const auto element =
        static_cast<std::uint32_t>(sampler.next_1d() * static_cast<float>(solution.mesh().count()));
    if (element >= solution.mesh().count()) continue;
    const Guide::Lobe lobe = guide.at(element, normal);
    if (lobe.empty()) continue;
    const V2f last(0x1.fffffep-1f * u.x, 0x1.fffffep-1f);
    on_the_horizon += lobe.sample(last).pdf_w == 0.0f;
    const Frame shading(normal);
    const auto drawn =
        GuidedDirections(bsdf, V3f(0, 0, 1), shading, lobe, 1.0f).sample(last, lobe.row_of(last.y));
    if (drawn) {
      ASSERT_TRUE(is_finite(drawn->weight)) << drawn->weight << " " << drawn->pdf_w;
    }
  }
  EXPECT_GT(on_the_horizon, 100);
}

TEST(Unbiased, HasLessNoiseThanThePathTracer) {
  const Scene scene(room());
  const Solution solution = make_solution(scene, Content::solved);
  const Guide guide(scene, solution);
  RayCounts ours, theirs;
  const test::Estimate estimate = test::mean_radiance(Unbiased(scene, {&solution, nullptr, &guide}, {}), eye,
                                                      V3f(0, 1, -0.3f), 0.95f, 30000, 1);
  const test::Estimate plain =
      test::mean_radiance(PathTracer(scene, {}), eye, V3f(0, 1, -0.3f), 0.95f, 30000, 1);
  EXPECT_LT(estimate.variance(), 0.5 * plain.variance());
}

// With a limit of few edges paths end as in the path tracer; with one of many, on the solution, which knows
// nothing of it.
TEST(Unbiased, EveryLengthOfPathIsCarriedOnce) {
  const Scene scene(room());
  const Solution solution = make_solution(scene, Content::solved);
  const Guide guide(scene, solution);
  for (const int depth : {1, 2, 3, 4, 5, 16}) {
    const PathLimits limits{.max_depth = depth};
    const test::Estimate ours = test::mean_radiance(Unbiased(scene, {&solution, nullptr, &guide}, limits), eye,
                                                    V3f(0.1f, 1, 0.4f), 0.8f, 40000, 1);
    const test::Estimate truth =
        test::mean_radiance(PathTracer(scene, limits), eye, V3f(0.1f, 1, 0.4f), 0.8f, 80000, 2);
    EXPECT_LT(std::abs(test::z_score(ours, truth)), 4.4) << "depth " << depth;  // level 1e-5 each
  }
}

// Clamps apply to each path as in the path tracer, whose expectation depends on how light is sampled: only what
// no clamp touches is the same.
TEST(Unbiased, ClampsAsThePathTracerDoes) {
  const Scene scene(room());
  const Solution solution = make_solution(scene, Content::solved);
  const Guide guide(scene, solution);
  const PathLimits dim{.clamp_direct = 1e-3f, .clamp_indirect = 1e-4f};
  const test::Estimate ours = test::mean_radiance(Unbiased(scene, {&solution, nullptr, &guide}, dim), eye,
                                                  V3f(0, 1, -0.3f), 0.8f, 5000, 1);
  EXPECT_LT(ours.mean(), 1e-2);
  EXPECT_GT(ours.mean(), 0.0);
}

TEST(Unbiased, WithoutASolutionItIsThePathTracer) {
  const Scene scene(mixed_room());
  const Unbiased unbiased(scene, {}, {});
  const PathTracer path(scene, {});
  RayCounts a, b;
  for (std::uint32_t i = 0; i < 500; ++i) {
    Sampler first(1, i, 0), second(1, i, 0);
    const Ray ray{V3f(0.5f), square_to_sphere(Sampler(2, i, 0).next_2d())};
    EXPECT_EQ(unbiased.radiance(ray, first, a).radiance, path.radiance(ray, second, b).radiance);
  }
  EXPECT_EQ(a.rays, b.rays);
  EXPECT_EQ(a.shadow_rays, b.shadow_rays);
}

}  // namespace
}  // namespace twopass
