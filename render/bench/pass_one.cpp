#include "render/bench/pass_one.h"

#include "render/image/compare.h"
#include "render/pass_one.h"
#include "render/render_image.h"

namespace twopass {

PassOneResult measure_pass_one(const BenchSubject& subject, const RadiosityOptions& options,
                               const BenchReference& reference) {
  // Enough for edges to be smooth; what remains is the solution's.
  constexpr int samples = 64;
  reset_peak_memory();
  constexpr IntegratorKind kind = IntegratorKind::radiosity;
  const Plan plan = plan_render(subject.needs, kind, subject.limits);
  const PixelWindow window{{0, 0}, {subject.width, subject.height}};
  const PreparedPassOne prepared =
      prepare_pass_one({.scene = subject.scene,
                        .plan = plan,
                        .integrator = kind,
                        .radiosity = radiosity_options(kind, subject.limits, subject.camera, window, options)});
  const auto integrator = make_integrator(kind, subject.scene, prepared.view(), subject.limits);
  PassOneResult result;
  result.memory_bytes = peak_memory_bytes();
  result.scene = subject.name;
  result.stats = prepared.solution->stats();
  result.solver = result.stats.solver;
  result.form_factors = result.stats.form_factors;
  result.time = prepared.time();
  Film film(subject.width, subject.height);
  render_image({.integrator = *integrator,
                .camera = subject.camera,
                .filter = box_filter(),
                .goal = {samples, 0.0, 0.0},
                .cone = subject.cone},
               film);
  const Comparison comparison = compare(film.resolve(), reference.picture);
  result.relmse = comparison.relmse - reference.relmse;
  result.energy_ratio = comparison.energy_ratio;
  return result;
}

}  // namespace twopass
