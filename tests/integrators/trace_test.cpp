#include "integrators/trace.h"

#include <gtest/gtest.h>

#include "integrators/make_integrator.h"
#include "radiosity/guide.h"
#include "render/core/warp.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

// Every kind of vertex: diffuse, mirror, glass; triangles and spheres; an open side with sky.
SceneDescription mixed_scene() {
  SceneDescription scene = test::unit_room(C3f(0.7f, 0.6f, 0.5f), C3f(2.0f), C3f(0.7f));
  scene.shapes.erase(scene.shapes.begin() + 1);
  scene.environment = Environment(C3f(0.3f));
  test::add_diffuse(scene, "lamp", Sphere{V3f(0.3f, 0.3f, 0.8f), 0.1f, false}, C3f(0.0f), C3f(5.0f));
  test::add_box(scene, "mirror", V3f(0.1f, 0.5f, 0.1f), V3f(0.3f, 0.7f, 0.5f),
                one_sided("mirror", Conductor{}));
  test::add_diffuse(scene, "glass", Sphere{V3f(0.7f, 0.5f, 0.3f), 0.2f, false}, C3f(0.0f));
  scene.materials.back() = interface_material("glass", Dielectric{});
  return scene;
}

std::vector<PathSample> samples_from(const V3f& origin, std::uint32_t count) {
  std::vector<PathSample> samples;
  for (std::uint32_t i = 0; i < count; ++i) {
    Sampler sampler(3, i, 0);
    const V3f direction = square_to_sphere(sampler.next_2d());
    samples.push_back({{origin, direction}, sampler});
  }
  return samples;
}

class TraceTest : public testing::TestWithParam<IntegratorKind> {};

// What a sample sees, and what it costs, must not depend on what is traced beside it: to the bit.
TEST_P(TraceTest, BundlesOfAnySizeSeeWhatSingleRaysSee) {
  const Scene scene(mixed_scene());
  RadiosityOptions options;
  options.max_elements = 200;
  options.rays_per_element = 64;
  std::optional<Solution> solution;
  if (reads_solution(GetParam())) solution.emplace(solve_radiosity(scene, options));
  std::optional<Guide> guide;
  if (is_guided(GetParam())) guide.emplace(scene, *solution);
  const auto integrator = make_integrator(
      GetParam(), scene, {solution ? &*solution : nullptr, nullptr, guide ? &*guide : nullptr}, {});
  const std::vector<PathSample> start = samples_from(V3f(0.5f, 0.2f, 0.5f), 3000);
  std::vector<PathSample> single = start;
  RayCounts single_counts;
  for (PathSample& sample : single)
    sample.seen = integrator->radiance(sample.ray, sample.sampler, single_counts);
  for (const std::size_t size : {2, 7, 16, 63, 64, 65, 1000}) {
    std::vector<PathSample> bundled = start;
    RayCounts counts;
    for (std::size_t first = 0; first < bundled.size(); first += size)
      integrator->trace(std::span(bundled).subspan(first, std::min(size, bundled.size() - first)), counts);
    EXPECT_EQ(counts.rays, single_counts.rays);
    EXPECT_EQ(counts.shadow_rays, single_counts.shadow_rays);
    EXPECT_EQ(counts.escaped_rays, single_counts.escaped_rays);
    for (std::size_t i = 0; i < start.size(); ++i) {
      ASSERT_EQ(bundled[i].seen.radiance, single[i].seen.radiance)
          << "sample " << i << " of bundles of " << size;
      ASSERT_EQ(bundled[i].seen.alpha, single[i].seen.alpha);
      ASSERT_EQ(bundled[i].sampler.next_1d(), Sampler(single[i].sampler).next_1d());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Integrators, TraceTest,
                         testing::Values(IntegratorKind::path, IntegratorKind::two_pass,
                                         IntegratorKind::unbiased, IntegratorKind::radiosity,
                                         IntegratorKind::direct),
                         [](const testing::TestParamInfo<IntegratorKind>& model) {
                           return std::string(name_of_value<IntegratorKind>(integrator_names, model.param));
                         });

// A bundle overwrites what its samples held before.
TEST(Trace, OldResultsAreForgotten) {
  const Scene scene(mixed_scene());
  const auto path = make_integrator(IntegratorKind::path, scene, {}, {});
  std::vector<PathSample> first = samples_from(V3f(0.5f, 0.2f, 0.5f), 100), second = first;
  for (PathSample& sample : second) sample.seen = {C3f(7.0f), 0.5f};
  RayCounts counts;
  path->trace(first, counts);
  path->trace(second, counts);
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].seen.radiance, second[i].seen.radiance);
}

TEST(Trace, NoSamplesAreNoWork) {
  const Scene scene(mixed_scene());
  RayCounts counts;
  make_integrator(IntegratorKind::path, scene, {}, {})->trace({}, counts);
  EXPECT_EQ(counts.rays, 0u);
}

}  // namespace
}  // namespace twopass
