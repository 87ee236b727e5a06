// A small picture of a scene, and what must hold of every picture.
#pragma once

#include <string>
#include <vector>

#include "radiosity/options.h"
#include "render/image/image.h"
#include "render/plan.h"
#include "render/render_image.h"

namespace twopass::stress {

/// How many times as long as usual a picture may take, CPU time: sanitizers slow down everything.
#if defined(__SANITIZE_THREAD__)
inline constexpr double patience = 40.0;
#elif defined(__SANITIZE_ADDRESS__)
inline constexpr double patience = 10.0;
#else
inline constexpr double patience = 1.0;
#endif

/// How light is computed: an integrator, and for those that read a solution, how that is found.
struct Way {
  IntegratorKind integrator = IntegratorKind::path;
  Solver solver = Solver::automatic;
  FormFactorMethod form_factors = FormFactorMethod::automatic;
};
/// Letters, digits and underscores: for names of tests.
std::string name_of(const Way& way);
/// Every integrator; the bare solution, too, by every solver and every form factor method.
std::vector<Way> all_ways();
/// Every integrator once.
std::vector<Way> all_integrators();

struct PictureOptions {
  int width = 8, height = 8, samples = 16;
  std::uint32_t seed = 1;
  PathLimits limits{};
  SamplerKind sampler = SamplerKind::independent;  ///< standard errors are honest
  std::size_t elements = 150;  ///< 0: pass one is as `twopass render` has it by default, judged by its bias
  std::uint32_t rays_per_element = 256;  ///< where elements are asked for
};

struct Picture {
  Image image;             ///< channels R G B A
  double mean = 0.0;       ///< over pixels and channels
  double error = 0.0;      ///< standard error of `mean`, by the scatter of the samples
  double brightest = 0.0;  ///< of all pixels and channels
  RenderOutcome outcome;
  double cpu_seconds = 0.0;
  std::vector<std::string> notes;  ///< of the radiosity pass
};

/// Renders the description through its camera; without one, from the middle of its bounds along +y.
Picture render(const SceneDescription& description, const Way& way, const PictureOptions& options = {});

/// What holds of any picture of any scene: every value finite, none below zero, alpha in [0, 1], no sample that
/// was not finite. The first thing that does not hold, in words; empty: all is well.
std::string fault_of(const Picture& picture);

}  // namespace twopass::stress
