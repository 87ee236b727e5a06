#include "render/session.h"

#include <cstdio>

#include "radiosity/solution_file.h"
#include "render/core/error.h"

namespace twopass {

namespace {

// A guide costs about this many rays: where fewer are to be cast, it would only cost.
constexpr double rays_of_guide = 1e6;
// Of the rays of a picture, those of its certificate.
constexpr double certificate_share = 0.05;

std::string reflections_text(int max_reflections) {
  return max_reflections < 0 ? "any number of reflections"
                             : "at most " + std::to_string(max_reflections) + " reflections";
}

// A solution of other paths than this render's would be a picture of neither.
Solution load_fitting_solution(const Scene& scene, const std::string& file, int max_reflections) {
  Solution solution = load_solution(file, scene);
  const int held = solution.stats().max_reflections;
  if (held != max_reflections)
    throw Error(file,
                "it holds light of " + reflections_text(held) + ", this render needs that of " +
                    reflections_text(max_reflections),
                "make it again with twopass solve --max-reflections " + std::to_string(max_reflections) +
                    ", or change --max-depth");
  return solution;
}

// The options of pass one that follow from the picture's.
RadiosityOptions options_of(const SessionSettings& settings) {
  RadiosityOptions options = settings.radiosity;
  options.seed = settings.seed;
  const int max_depth = settings.limits.max_depth;
  options.max_reflections = max_depth < 0 ? -1 : max_depth - edges_to_solution(settings.integrator);
  if (settings.integrator == IntegratorKind::two_pass)
    options.gathered_pixels =
        static_cast<std::size_t>(settings.width) * static_cast<std::size_t>(settings.height);
  return options;
}

}  // namespace

Session::Session(const Scene& scene, const SessionSettings& settings, const Plan& plan, const Console& console)
    : scene_(scene), kind_(settings.integrator), limits_(settings.limits), seed_(settings.seed) {
  if (plan.radiosity_pass) {
    const Stopwatch stopwatch;
    solve(options_of(settings), settings.solution_file, console);
    if (plan.indirect_field) prepare_field(console);
    radiosity_time_ = stopwatch.elapsed();
  } else if (!settings.solution_file.empty()) {
    for (const Skipped& skipped : plan.skipped)
      if (skipped.what == "radiosity pass")
        console.note(settings.solution_file + ": not needed, because " + skipped.why);
  }
  const Stopwatch stopwatch;
  if (solution_ && is_guided(kind_)) guide_.emplace(scene, *solution_);
  guide_time_ = stopwatch.elapsed();
  integrator_ = make_integrator(kind_, scene, solution(), field_ ? &*field_ : nullptr, limits_,
                                guide_ ? &*guide_ : nullptr);
}

void Session::solve(const RadiosityOptions& options, const std::string& solution_file, const Console& console) {
  const Stopwatch stopwatch;
  solution_.emplace(solution_file.empty()
                        ? solve_radiosity(scene_, options)
                        : load_fitting_solution(scene_, solution_file, options.max_reflections));
  const RadiosityStats& stats = solution_->stats();
  for (const std::string& note : stats.notes) console.note(note);
  if (!solution_file.empty()) console.note("radiosity pass: taken from " + solution_file);
  char text[200];
  std::snprintf(text, sizeof text, "radiosity: %zu elements, %s, %s, %zu iterations, error bound %.2g, %.2f s",
                stats.elements, stats.form_factors.c_str(), stats.solver.c_str(), stats.iterations,
                stats.error_bound, stopwatch.seconds());
  console.note(text);
}

void Session::prepare_field(const Console& console) {
  const Stopwatch stopwatch;
  IndirectFieldOptions options;
  options.seed = seed_;
  field_.emplace(scene_, *solution_, options);
  char text[120];
  std::snprintf(text, sizeof text,
                "indirect light: looked up on %.0f %% of the area, gathered elsewhere, %.2f s",
                100.0 * field_->trusted_share(), stopwatch.seconds());
  console.note(text);
}

std::optional<Certificate> Session::certify_picture(const Camera& camera, const PixelWindow& window,
                                                    const RayCounts& counts) const {
  if (!solution_ || kind_ != IntegratorKind::two_pass) return std::nullopt;
  const double rays = certificate_share * static_cast<double>(counts.rays + counts.shadow_rays);
  std::optional<Guide> guide;
  if (rays > 2.0 * rays_of_guide) guide.emplace(scene_, *solution_);
  PathLimits limits = limits_;
  limits.clamp_direct = limits.clamp_indirect = infinity_f;
  const std::unique_ptr<Integrator> truth =
      make_integrator(IntegratorKind::unbiased, scene_, solution(), nullptr, limits, guide ? &*guide : nullptr);
  return certify({.biased = *integrator_,
                  .unbiased = *truth,
                  .camera = camera,
                  .width = window.size.x,
                  .height = window.size.y,
                  .corner = window.corner,
                  .seed = seed_,
                  .most_rays = rays});
}

}  // namespace twopass
