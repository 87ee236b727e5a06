// What a scene needs and what can be skipped, decided before anything is computed.
#pragma once

#include <string>
#include <vector>

#include "integrators/make_integrator.h"
#include "render/load/load.h"

namespace twopass {

/// Facts about a scene that decide which parts of the program run.
struct SceneNeeds {
  bool light = false;               ///< something emits
  bool diffuse_reflection = false;  ///< some surface reflects diffusely
  bool specular = false;            ///< some surface is a mirror or glass
  bool caustics = false;            ///< lamps, and surfaces that scatter without diffusing
  bool see_through = false;         ///< light passes straight through some surface: a mask
  bool sky = false;                 ///< the environment shines
};
SceneNeeds needs_of(const SceneDescription& scene);

/// Which passes will run for one render.
struct Plan {
  bool radiosity_pass = false;
  bool indirect_field = false;  ///< with it: what need not be gathered is looked up (radiosity, R39)
  bool guide = false;           ///< with it: directions are drawn where light comes from (radiosity, R41)
  bool caustic_map = false;     ///< with it: caustics are looked up, where there may be any (radiosity, R49)
  std::vector<Skipped> skipped;
};
/// What the integrator needs of the scene. The picture is the same with and without what is skipped.
Plan plan_render(const SceneNeeds& needs, IntegratorKind integrator, const PathLimits& limits);

}  // namespace twopass
