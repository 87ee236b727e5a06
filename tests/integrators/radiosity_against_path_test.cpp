// The two halves against each other: the irradiance of every element by pass one, and by the path tracer, which
// shares nothing with it.
#include <gtest/gtest.h>

#include "integrators/path.h"
#include "radiosity/solution.h"
#include "render/core/warp.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

// Mean irradiance over the element by cosine-distributed path-traced rays from uniform points of it.
test::Estimate traced_irradiance(const PathTracer& path, const ElementMesh& mesh, std::uint32_t element,
                                 int samples) {
  const Patch patch = mesh.patch(element);
  test::Estimate estimate;
  RayCounts counts;
  for (int i = 0; i < samples; ++i) {
    Sampler sampler(77, element, static_cast<std::uint32_t>(i));
    const V2f u = sampler.next_2d();
    const ElementPoint point = patch.sample(u);
    const Frame frame{V3f(point.normal)};
    const V3f w = frame.to_world(square_to_cosine_hemisphere(sampler.next_2d()));
    estimate.add(pi * path.radiance({point.ray_position(), w}, sampler, counts).radiance.x);
  }
  return estimate;
}

struct Method {
  FormFactorMethod form_factors;
  double allowance;  // of the irradiance, for elements of finite size
};

// Paths are traced once for all methods, which share the elements.
void expect_agreement(const SceneDescription& description, const std::vector<Method>& methods,
                      std::size_t elements) {
  const Scene scene(description);
  const PathTracer path(scene, {});
  std::vector<test::Estimate> traced;
  for (const Method& method : methods) {
    SCOPED_TRACE(name_of_value<FormFactorMethod>(form_factor_method_names, method.form_factors));
    RadiosityOptions options;
    options.form_factors = method.form_factors;
    options.max_elements = elements;
    options.rays_per_element = 4096;
    options.relative_error = 1e-5;
    const Solution solution = solve_radiosity(scene, options);
    const ElementMesh& mesh = solution.mesh();
    ASSERT_GT(mesh.count(), 20u);
    if (traced.empty())
      for (std::uint32_t e = 0; e < mesh.count(); ++e) traced.push_back(traced_irradiance(path, mesh, e, 2000));
    ASSERT_EQ(mesh.count(), traced.size());
    // All elements together err with probability 1e-3 (Sidak); Sobol samples scatter less than assumed.
    const double level = test::sidak(1e-3, mesh.count());
    double sum_z = 0.0;
    for (std::uint32_t e = 0; e < mesh.count(); ++e) {
      const double ours = solution.irradiances()[e].total().x;
      const double error = std::hypot(traced[e].standard_error(), method.allowance * ours);
      const double z = (ours - traced[e].mean()) / error;
      EXPECT_GT(test::two_sided_p(z), level) << "element " << e << ": " << ours << " against "
                                             << traced[e].mean() << " +- " << traced[e].standard_error();
      sum_z += z;
    }
    // Individually within noise is not enough: a common factor shows in the mean.
    EXPECT_LT(std::abs(sum_z) / std::sqrt(static_cast<double>(mesh.count())), 5.0);
  }
}

// Where the elements hold the solution exactly (the inside of a sphere) only noise may differ.
TEST(RadiosityAgainstPath, InsideASphere) {
  SceneDescription scene;
  test::add_diffuse(scene, "dome", Sphere{V3f(0.0f), 1.0f, true}, C3f(0.6f), C3f(1.0f));
  expect_agreement(scene, {{FormFactorMethod::rays, 0.01}}, 128);
}

// Elements of finite size smooth the light; 2 % covers that of these at 12 x 12 a wall.
TEST(RadiosityAgainstPath, UnitRoomByExactFactorsAndByRays) {
  expect_agreement(test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.5f)),
                   {{FormFactorMethod::exact, 0.02}, {FormFactorMethod::rays, 0.03}}, 800);
}

// What the coats of plastics and the metal in a mixture reflect reaches other surfaces, and those again.
TEST(RadiosityAgainstPath, RoomWithGlossyWalls) {
  SceneDescription scene = test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.5f));
  Plastic smooth;
  smooth.base_reflectance = C3f(0.4f);
  RoughPlastic rough;
  rough.base_reflectance = C3f(0.4f);
  rough.prepare();
  const auto leaf = [](const Bsdf& bsdf) {
    return std::make_shared<const MaterialNode>(MaterialNode{TexturedModel{bsdf, {}}});
  };
  const Mixture mixture{C3f(0.4f), leaf(Diffuse{C3f(0.6f)}), leaf(Conductor{})};
  scene.materials[2] = one_sided("smooth", smooth);
  scene.materials[3] = one_sided("rough", rough);
  scene.materials[4] =
      one_sided("mixed", MaterialSide(std::make_shared<const MaterialNode>(MaterialNode{mixture})));
  expect_agreement(scene, {{FormFactorMethod::rays, 0.03}}, 800);
}

TEST(RadiosityAgainstPath, RoomWithABox) {
  SceneDescription scene = test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.5f));
  test::add_box(scene, "box", V3f(0.3f), V3f(0.6f), one_sided("box", Diffuse{C3f(0.5f)}));
  expect_agreement(scene, {{FormFactorMethod::exact, 0.03}}, 800);
}

}  // namespace
}  // namespace twopass
