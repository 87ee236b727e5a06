#include "render/plan.h"

#include "integrators/clamp.h"

namespace twopass {

SceneNeeds needs_of(const SceneDescription& scene) {
  SceneNeeds needs;
  needs.sky = !scene.environment.is_black();
  needs.light = needs.sky || !scene.punctual_lights.empty();
  bool has_lamps = false, has_others = false;
  for (const Shape& shape : scene.shapes) {
    if (is_emitter(shape)) needs.light = has_lamps = true;
    for (const MaterialSide& side : scene.materials[shape.material].side) {
      if (!is_black(side.traits().mean_diffuse_reflectance)) needs.diffuse_reflection = true;
      if (side.traits().may_be_specular) needs.specular = true;
      if (side.traits().is_see_through) needs.see_through = true;
      if (side.scatters_without_diffusing()) has_others = true;
    }
  }
  needs.caustics = has_lamps && has_others;
  return needs;
}

Plan plan_render(const SceneNeeds& needs, IntegratorKind integrator, const PathLimits& limits) {
  Plan plan;
  const auto skip = [&](const char* why) { plan.skipped.push_back({"radiosity pass", why}); };
  if (!reads_solution(integrator))
    skip("the integrator does not read it");
  else if (!needs.light)
    skip("the scene has no light");
  else if (!needs.diffuse_reflection)
    skip("no surface reflects diffusely");
  else if (needs.see_through && integrator != IntegratorKind::radiosity)
    skip("light passes through masks, which the solution takes for opaque");
  else if (limits.max_depth >= 0 && limits.max_depth < edges_to_solution(integrator))
    skip("paths are too short to read it");
  else
    plan.radiosity_pass = true;
  if (plan.radiosity_pass && integrator == IntegratorKind::two_pass) {
    // Under a sky gather rays pay twice: they find the sky, too.
    const char* why = needs.sky            ? "gather rays are needed to find the sky"
                      : is_clamped(limits) ? "clamps are for single paths"
                                           : nullptr;
    if (why)
      plan.skipped.push_back({"look-ups of indirect light", why});
    else
      plan.indirect_field = true;
  }
  plan.caustic_map =
      plan.radiosity_pass && integrator == IntegratorKind::two_pass && needs.caustics && !is_clamped(limits);
  plan.guide = plan.radiosity_pass && is_guided(integrator);
  return plan;
}

}  // namespace twopass
