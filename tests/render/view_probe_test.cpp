#include "render/view_probe.h"

#include <gtest/gtest.h>

#include "render/pass_one.h"
#include "render/render_image.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

constexpr PixelWindow window{{0, 0}, {48, 32}};

struct View {
  Scene scene;
  Camera camera;
  View(SceneDescription description, const V3d& from, const V3d& to)
      : scene(std::move(description)),
        camera({look_at(from, to, {0, 0, 1}, "test"), 60.0, FovAxis::x}, window.size.x, window.size.y) {}
  [[nodiscard]] Plan plan(IntegratorKind kind = IntegratorKind::two_pass) const {
    Plan plan = plan_render(needs_of(scene.description()), kind, {});
    fit_to_view(plan, kind, scene, camera, window, {}, 0);
    return plan;
  }
};

View room() { return {test::furnished_room(), {0.5, 0.05, 0.5}, {0.5, 1.0, 0.4}}; }

// A glass ball over the ground, under a sky that is bright above.
View glass_ball() {
  SceneDescription scene;
  test::add_diffuse(scene, "ground", test::quad(V3f(-20, -20, 0), V3f(40, 0, 0), V3f(0, 40, 0)), C3f(0.3f));
  scene.materials.push_back(interface_material("glass", Dielectric{}));
  Shape ball;
  ball.name = "ball";
  ball.geometry = Sphere{V3f(0.0f, 0.0f, 1.01f), 1.0f, false};
  ball.material = 1;
  scene.shapes.push_back(ball);
  scene.environment = Environment(C3f(1.0f, 1.1f, 1.3f));
  return {std::move(scene), {0, -5, 2}, {0, 0, 0.8}};
}

// One convex thing: none of its light comes back to it.
View ball_in_the_sky() {
  SceneDescription scene;
  test::add_diffuse(scene, "ball", Sphere{V3f(0.0f), 1.0f, false}, C3f(0.6f));
  scene.environment = Environment(C3f(1.0f));
  return {std::move(scene), {0, -4, 0}, {0, 0, 0}};
}

TEST(ViewProbe, ARoomGainsByPassOne) {
  const View view = room();
  EXPECT_GT(probe_view(view.scene, view.camera, window, {}, 0).gain(), 2.0);
  EXPECT_TRUE(view.plan().radiosity_pass);
  EXPECT_TRUE(view.plan().skipped.empty());
}

// In the measure of a picture's noise, so that it foretells how many samples that will need: where it is dark,
// less.
TEST(ViewProbe, ItsVarianceIsThatOfAPicture) {
  for (const float brightness : {1.0f, 0.03f}) {
    SceneDescription description = test::furnished_room();
    for (Shape& shape : description.shapes)
      for (C3f& radiance : shape.radiance) radiance *= brightness;
    const View view{std::move(description), {0.5, 0.05, 0.5}, {0.5, 1.0, 0.4}};
    Film film(window.size.x, window.size.y);
    const auto path = make_integrator(IntegratorKind::path, view.scene, {}, {});
    render_image({.integrator = *path, .camera = view.camera, .filter = box_filter(), .goal = {256, 0.0, 0.0}},
                 film);
    const double expected = 256.0 * film.noise().relmse;
    const ViewProbe probe = probe_view(view.scene, view.camera, window, {}, 0);
    EXPECT_GT(probe.variance, 0.5 * expected) << brightness;
    EXPECT_LT(probe.variance, 2.0 * expected) << brightness;
    EXPECT_NEAR(probe.error_of(400.0),
                0.05 * std::sqrt(probe.variance_without + 0.05 * (probe.variance - probe.variance_without)),
                1e-6);
  }
}

TEST(ViewProbe, PassOneIsSkippedWhereTheViewGainsTooLittleByIt) {
  for (const View& view : {glass_ball(), ball_in_the_sky()}) {
    const Plan plan = view.plan();
    EXPECT_FALSE(plan.radiosity_pass);
    EXPECT_FALSE(plan.indirect_field);
    EXPECT_FALSE(plan.guide);
    ASSERT_EQ(plan.skipped.size(), 1u);
    EXPECT_EQ(plan.skipped[0].what, "radiosity pass");
    // Who asks for a solution gets it.
    EXPECT_TRUE(view.plan(IntegratorKind::unbiased).radiosity_pass);
    EXPECT_TRUE(view.plan(IntegratorKind::radiosity).radiosity_pass);
  }
  EXPECT_EQ(ball_in_the_sky().plan().skipped[0].why,
            "the picture sees no light that goes from one diffuse surface to another");
}

TEST(ViewProbe, ThePictureIsTheSameWithAndWithoutWhatIsSkipped) {
  const View view = glass_ball();
  const Plan all = plan_render(needs_of(view.scene.description()), IntegratorKind::two_pass, {});
  ASSERT_TRUE(all.radiosity_pass);
  const auto mean = [&](const Plan& plan, std::uint32_t seed) {
    const PreparedPassOne pass_one = prepare_pass_one(
        {.scene = view.scene,
         .plan = plan,
         .integrator = IntegratorKind::two_pass,
         .radiosity = radiosity_options(IntegratorKind::two_pass, {}, view.camera, window, {})});
    EXPECT_EQ(pass_one.solution != nullptr, plan.radiosity_pass);
    const auto integrator = make_integrator(IntegratorKind::two_pass, view.scene, pass_one.view(), {});
    test::Estimate estimate;
    RayCounts counts;
    for (std::uint32_t i = 0; i < 40000; ++i) {
      Sampler sampler(seed, 0, i);
      const V2f u = sampler.next_2d();
      const CameraRay seen = view.camera.ray({u.x * 48.0f, u.y * 32.0f});
      estimate.add(integrator->radiance(seen.ray, sampler, counts).radiance.x);
    }
    return estimate;
  };
  const test::Estimate with = mean(all, 1), without = mean(view.plan(), 2);
  EXPECT_NEAR(with.mean(), without.mean(),
              4.4 * std::hypot(with.standard_error(), without.standard_error()) + 0.002 * without.mean());
}

// A floor of 80,000 triangles: 10,000 elements at least, worth some 5 million rays.
TEST(ViewProbe, PassOneIsSkippedWhereAShortPictureWouldWaitForManySurfaces) {
  SceneDescription scene = test::furnished_room();
  Mesh floor;
  constexpr std::uint32_t side = 200;
  for (std::uint32_t y = 0; y <= side; ++y)
    for (std::uint32_t x = 0; x <= side; ++x)
      floor.positions.emplace_back(static_cast<float>(x) / side, static_cast<float>(y) / side, 0.0f);
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t at = y * (side + 1) + x;
      floor.triangles.emplace_back(at, at + 1, at + side + 1);
      floor.triangles.emplace_back(at + 1, at + side + 2, at + side + 1);
    }
  scene.shapes[0].geometry = floor;
  const View view{std::move(scene), {0.5, 0.05, 0.5}, {0.5, 1.0, 0.4}};
  const auto has_pass_one = [&](double picture_rays, bool has_solution) {
    Plan plan = plan_render(needs_of(view.scene.description()), IntegratorKind::two_pass, {});
    fit_to_view(plan, IntegratorKind::two_pass, view.scene, view.camera, window, {}, 0, picture_rays,
                has_solution);
    EXPECT_EQ(plan.skipped.empty(), plan.radiosity_pass);
    return plan.radiosity_pass;
  };
  EXPECT_FALSE(has_pass_one(1e5, false));
  EXPECT_TRUE(has_pass_one(1e5, true));
  EXPECT_TRUE(has_pass_one(1e8, false));
  EXPECT_TRUE(has_pass_one(0.0, false));
}

TEST(ViewProbe, ASolutionThatIsThereIsUsed) {
  const View view = glass_ball();
  Plan plan = plan_render(needs_of(view.scene.description()), IntegratorKind::two_pass, {});
  fit_to_view(plan, IntegratorKind::two_pass, view.scene, view.camera, window, {}, 0, 0.0, true);
  EXPECT_TRUE(plan.radiosity_pass);
}

}  // namespace
}  // namespace twopass
