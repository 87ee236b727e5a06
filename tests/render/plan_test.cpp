#include "render/plan.h"

#include <gtest/gtest.h>

#include "tests/support/scenes.h"

namespace twopass {
namespace {

Plan plan(const SceneDescription& scene, IntegratorKind kind, int max_depth = -1) {
  return plan_render(needs_of(scene), kind, {max_depth, 5, false});
}

TEST(Plan, ALitDiffuseRoomNeedsTheRadiosityPass) {
  const SceneDescription room = test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.5f));
  EXPECT_TRUE(plan(room, IntegratorKind::two_pass).radiosity_pass);
  EXPECT_TRUE(plan(room, IntegratorKind::two_pass).skipped.empty());
  EXPECT_TRUE(plan(room, IntegratorKind::unbiased).radiosity_pass);
  EXPECT_TRUE(plan(room, IntegratorKind::radiosity).radiosity_pass);
}

TEST(Plan, EveryReasonToSkipIsGiven) {
  const SceneDescription lit = test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.5f));
  const SceneDescription dark = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
  const SceneDescription black = test::unit_room(C3f(0.0f), C3f(1.0f), C3f(0.0f));
  SceneDescription masked = lit;
  masked.materials[0] = material_of("hole", MaterialSide(Null{}));
  const struct {
    Plan plan;
    std::string why;
  } cases[] = {
      {plan(lit, IntegratorKind::path), "the integrator does not read it"},
      {plan(lit, IntegratorKind::direct), "the integrator does not read it"},
      {plan(dark, IntegratorKind::two_pass), "the scene has no light"},
      {plan(black, IntegratorKind::two_pass), "no surface reflects diffusely"},
      {plan(masked, IntegratorKind::two_pass),
       "light passes through masks, which the solution takes for opaque"},
      {plan(masked, IntegratorKind::unbiased),
       "light passes through masks, which the solution takes for opaque"},
      {plan(lit, IntegratorKind::unbiased, 2), "paths are too short to read it"},
      {plan(lit, IntegratorKind::two_pass, 2), "paths are too short to read it"},
  };
  for (const auto& c : cases) {
    EXPECT_FALSE(c.plan.radiosity_pass);
    ASSERT_EQ(c.plan.skipped.size(), 1u);
    EXPECT_EQ(c.plan.skipped[0].what, "radiosity pass");
    EXPECT_EQ(c.plan.skipped[0].why, c.why);
  }
  EXPECT_TRUE(plan(lit, IntegratorKind::two_pass, 3).radiosity_pass);
  EXPECT_TRUE(plan(lit, IntegratorKind::radiosity, 2).radiosity_pass);
}

TEST(Plan, LooksLightUpUnlessASkyOrClampsForbidIt) {
  const SceneDescription lit = test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.5f));
  SceneDescription open = lit;
  open.environment = Environment(C3f(1.0f));
  EXPECT_TRUE(plan(lit, IntegratorKind::two_pass).indirect_field);
  EXPECT_TRUE(plan(lit, IntegratorKind::two_pass).guide);
  EXPECT_TRUE(plan(lit, IntegratorKind::unbiased).guide);
  EXPECT_FALSE(plan(lit, IntegratorKind::path).guide);
  EXPECT_FALSE(plan(lit, IntegratorKind::radiosity).guide);
  const Plan clamped = plan_render(needs_of(lit), IntegratorKind::two_pass, {.clamp_indirect = 1.0f});
  for (const auto& [p, why] :
       {std::pair{plan(open, IntegratorKind::two_pass), "gather rays are needed to find the sky"},
        std::pair{clamped, "clamps are for single paths"}}) {
    EXPECT_TRUE(p.radiosity_pass);
    EXPECT_FALSE(p.indirect_field);
    ASSERT_EQ(p.skipped.size(), 1u);
    EXPECT_EQ(p.skipped[0].what, "look-ups of indirect light");
    EXPECT_EQ(p.skipped[0].why, why);
  }
}

TEST(Plan, SkyAndSpecularSurfacesAreSeen) {
  SceneDescription scene = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
  EXPECT_FALSE(needs_of(scene).light);
  scene.environment = Environment(C3f(0.0f, 0.0f, 1.0f));
  EXPECT_TRUE(needs_of(scene).light);
  EXPECT_FALSE(needs_of(scene).specular);
  scene.materials[0] = one_sided("mirror", Conductor{});
  EXPECT_TRUE(needs_of(scene).specular);
}

}  // namespace
}  // namespace twopass
