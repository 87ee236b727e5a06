#include "render/pass_one.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include "radiosity/view_parts.h"

namespace twopass {

namespace {

// Of the time that a picture may take, and what pass one costs for each element, look-ups included: measured in
// the scenes of scenes/ (130 to 250 microseconds of CPU).
constexpr double share_of_pass_one = 0.15, seconds_of_an_element = 2e-4;
// Of the rays that a picture is worth, those that find the light at corners of elements: fewer show as blotches
// in pictures that have less noise, more cost more than they save (measured at 16 spp, radiosity, R39).
constexpr double share_of_corners = 0.0025;
// Of a guide.
constexpr double rays_of_a_cell = Guide::rows * Guide::columns;
// Of a thread, of CPU time.
constexpr double rays_a_second = 5e6;

// Most diffuse reflections that the solution may hold; -1: all.
int max_reflections_of(IntegratorKind integrator, const PathLimits& limits) {
  return limits.max_depth < 0 ? -1 : limits.max_depth - edges_to_solution(integrator);
}

// Camera rays evenly over the picture.
std::vector<Ray> view_rays(const Camera& camera, const PixelWindow& window, std::uint32_t seed) {
  constexpr std::uint32_t count = 1u << 14;
  std::vector<Ray> rays;
  for (std::uint32_t k = 0; k < count; ++k) {
    Sampler sampler(seed, 0, k);
    const V2f u = sampler.next_2d();
    const V2f at(static_cast<float>(window.corner.x) + u.x * static_cast<float>(window.size.x),
                 static_cast<float>(window.corner.y) + u.y * static_cast<float>(window.size.y));
    rays.push_back((camera.has_lens() ? camera.ray(at, sampler.next_2d()) : camera.ray(at)).ray);
  }
  return rays;
}

// Light is looked up where the picture's rays see it: at elements that few of them see it may as well be
// gathered.
std::vector<bool> seen_elements(std::span<const double> parts) {
  std::vector<bool> seen;
  for (const double part : parts) seen.push_back(part > 0.0);
  return seen;
}

// Gathering is guided where indirect light is not looked up. Larger cells than for paths, of which only the
// first direction is gathered.
GuideOptions guide_options(const PassOneJob& job, const PreparedPassOne& done, const std::vector<bool>& seen) {
  constexpr std::size_t least_cells = 64;
  GuideOptions options;
  options.seed = job.radiosity.seed;
  if (job.integrator == IntegratorKind::two_pass) options.max_cells = 4096;
  if (job.picture_rays > 0.0)
    options.max_cells =
        std::clamp(static_cast<std::size_t>(share_of_pass_one * job.picture_rays / rays_of_a_cell), least_cells,
                   options.max_cells);
  if (job.integrator != IntegratorKind::two_pass) return options;
  options.cell_size = 0.05f;
  options.wanted = seen;
  options.without_caustics = done.caustics != nullptr;
  if (!done.field) return options;
  options.wanted.resize(done.solution->mesh().count(), true);
  for (std::uint32_t e = 0; e < done.solution->mesh().count(); ++e)
    if (done.field->known(e) >= Known::indirect) options.wanted[e] = false;
  return options;
}

// Whether the picture is of elements, none of which receives any light, as far as the solution knows. Paths
// need no more rays then, and find what it may have missed.
bool looks_black(const Solution& solution, std::span<const double> parts) {
  bool sees_elements = false;
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    if (!(parts[i] > 0.0)) continue;
    sees_elements = true;
    if (!is_black(solution.irradiances()[i].total())) return false;
  }
  return sees_elements;
}

// What is read of the solution; that is left out where it is no use.
void prepare_reading(const PassOneJob& job, PreparedPassOne& done) {
  std::uint64_t rays = 0;
  std::vector<double> parts =
      parts_of(done.solution->mesh(), seen_points(job.scene, job.radiosity.view, job.radiosity.seed, rays));
  if (looks_black(*done.solution, parts)) {
    done.solution.reset();
    done.caustics.reset();
    done.left_out = "it finds no light where the picture looks";
    return;
  }
  const std::vector<bool> seen = seen_elements(parts);
  Stopwatch stopwatch;
  done.guide.reset();
  if (job.plan.indirect_field) {
    IndirectFieldOptions options;
    options.seed = job.radiosity.seed;
    options.wanted = seen;
    options.parts = std::move(parts);
    options.dividing_rays = share_of_pass_one * job.picture_rays;
    options.affordable_rays = share_of_corners * job.picture_rays;
    options.without_caustics = done.caustics != nullptr;
    done.field = std::make_unique<const IndirectField>(job.scene, *done.solution, options);
    done.field_time += stopwatch.elapsed();
  }
  if (job.plan.guide) {
    stopwatch = Stopwatch();
    done.guide = std::make_unique<const Guide>(job.scene, *done.solution, guide_options(job, done, seen));
    done.guide_time += stopwatch.elapsed();
  }
}

// Fewer for short pictures, whose own noise hides that of the particles.
CausticParticlesOptions particle_options(const PassOneJob& job) {
  constexpr double least_particles = 0x1p16, rays_of_a_particle = 3.0;
  CausticParticlesOptions options{.seed = job.radiosity.seed};
  if (job.picture_rays > 0.0) {
    const double affordable = share_of_pass_one * job.picture_rays / rays_of_a_particle;
    options.particles = static_cast<std::size_t>(
        std::clamp(affordable, least_particles, static_cast<double>(options.particles)));
  }
  return options;
}

// `particles`: shot where they are needed, and kept for more than one solution.
PreparedPassOne prepare(PassOneJob job, std::optional<CausticParticles>& particles) {
  PreparedPassOne done;
  if (!job.plan.radiosity_pass) return done;
  Stopwatch stopwatch;
  if (!job.solved || job.plan.caustic_map) {
    particles.emplace(job.scene, particle_options(job));
    if (job.plan.caustic_map) done.caustics = std::make_unique<const CausticMap>(job.scene, *particles);
    done.caustics_time = stopwatch.elapsed();
    stopwatch = Stopwatch();
    if (!job.solved)
      done.solution = std::make_unique<const Solution>(solve_radiosity(job.scene, job.radiosity, &*particles));
  }
  if (job.solved) done.solution = std::make_unique<const Solution>(std::move(*job.solved));
  done.solution_time = stopwatch.elapsed();
  prepare_reading(job, done);
  return done;
}

std::string words_for(const Certificate& found) {
  if (!(found.ci95 < std::abs(found.mean))) return "two passes would show light where paths find hardly any: ";
  char text[160];
  std::snprintf(text, sizeof text, "two passes would be biased by %+.2f %% +- %.2f %%: ", 100.0 * found.mean,
                100.0 * found.ci95);
  return text;
}

// Cuts the elements that paths found guilty, so that as much less guilt is left as the bias has to be smaller,
// and solves again. False: there are none, or there are as many elements as there may be.
bool refine(const PassOneJob& job, const Certificate& found, double most_bias,
            const CausticParticles& particles, PreparedPassOne& done) {
  const ElementMesh& mesh = done.solution->mesh();
  RadiosityOptions most = job.radiosity;
  most.refinement = 1;
  most.affordable_elements = 0;
  // At most twice as many, so that what comes next is better informed; few, where there is hardly time for
  // these.
  const bool is_short =
      job.radiosity.affordable_elements > 0 && job.radiosity.affordable_elements < 2 * mesh.count();
  const std::size_t limit =
      std::min(element_limit(job.scene, most), is_short ? mesh.count() + mesh.count() / 4 : 2 * mesh.count());
  if (limit < mesh.count() + 3) return false;
  const std::vector<double> guilt = guilt_of(mesh, done.solution->irradiances(), found.of_element);
  const double all = std::accumulate(guilt.begin(), guilt.end(), 0.0);
  const double part = std::clamp(0.5 * most_bias / std::abs(found.mean), 0.0, 0.5);
  const std::vector<std::uint8_t> cuts = cuts_for(guilt, part * all, limit);
  if (std::all_of(cuts.begin(), cuts.end(), [](std::uint8_t times) { return times == 0; })) return false;
  const Stopwatch stopwatch;
  // Field and guide are of the solution.
  done.field.reset();
  done.guide.reset();
  done.solution = std::make_unique<const Solution>(
      solve_radiosity_again(job.scene, *done.solution, cuts, job.radiosity, &particles));
  done.solution_time += stopwatch.elapsed();
  prepare_reading(job, done);
  return true;
}

// What two passes are judged by, with so many rays for all of it.
class Truth {
 public:
  // The guide of a two-pass picture is only for where it gathers: paths have their own, as fine as they are
  // many. What clamps do to the picture is part of its bias. REQUIRES: there is a solution; all outlive this.
  Truth(const Scene& scene, const PreparedPassOne& pass_one, PathLimits limits, double rays) : rays_(rays) {
    constexpr double share_of_guide = 0.3;
    constexpr std::size_t least_cells = 512;
    PassOne view = pass_one.view();
    GuideOptions options;
    options.max_cells =
        std::min(options.max_cells, static_cast<std::size_t>(share_of_guide * rays / rays_of_a_cell));
    if (options.max_cells >= least_cells) view.guide = &guide_.emplace(scene, *pass_one.solution, options);
    limits.clamp_direct = limits.clamp_indirect = infinity_f;
    integrator_ = make_integrator(IntegratorKind::unbiased, scene, view, limits);
  }
  Truth(const Truth&) = delete;
  Truth& operator=(const Truth&) = delete;

  [[nodiscard]] const Integrator& integrator() const { return *integrator_; }
  [[nodiscard]] std::uint64_t rays_spent() const { return guide_ ? guide_->rays() : 0; }
  [[nodiscard]] double rays_left() const { return rays_ - static_cast<double>(rays_spent()); }

 private:
  double rays_;
  std::optional<Guide> guide_;
  std::unique_ptr<const Integrator> integrator_;
};

}  // namespace

RadiosityOptions radiosity_options(IntegratorKind integrator, const PathLimits& limits, const Camera& camera,
                                   const PixelWindow& window, RadiosityOptions asked, const PictureGoal& goal) {
  asked.max_reflections = max_reflections_of(integrator, limits);
  if (integrator != IntegratorKind::two_pass) return asked;
  asked.gathered_pixels = static_cast<std::size_t>(camera.width()) * static_cast<std::size_t>(camera.height());
  if (goal.relative_error > 0.0) asked.picture_error = goal.relative_error;
  if (goal.cpu_seconds > 0.0)
    asked.affordable_elements = std::max<std::size_t>(
        1, static_cast<std::size_t>(share_of_pass_one * goal.cpu_seconds / seconds_of_an_element));
  asked.view = view_rays(camera, window, asked.seed);
  return asked;
}

PreparedPassOne prepare_pass_one(PassOneJob job) {
  std::optional<CausticParticles> particles;
  return prepare(std::move(job), particles);
}

PictureGoal picture_goal(const SamplingGoal& sampling, const PixelWindow& window, int threads,
                         const std::optional<ViewProbe>& probe) {
  PictureGoal goal{.rays = rays_of(sampling, window, threads),
                   .cpu_seconds = sampling.seconds * threads,
                   .relative_error = sampling.relative_error};
  const double e = sampling.relative_error;
  if (!probe) return goal;
  const double pixels = static_cast<double>(window.size.x) * window.size.y;
  double samples = sampling.samples_per_pixel > 0 ? sampling.samples_per_pixel : infinity_f;
  if (sampling.seconds > 0.0)
    samples = std::min(samples, goal.cpu_seconds * rays_a_second / (probe->rays_without * pixels));
  // Only finer than usual: what short pictures may have is a question of time.
  if (!(e > 0.0) && std::isfinite(samples))
    goal.relative_error = std::min(RadiosityOptions{}.picture_error, probe->error_of(samples));
  if (sampling.samples_per_pixel == 0 && !(e > 0.0)) return goal;
  double paths = sampling.samples_per_pixel > 0 ? sampling.samples_per_pixel * probe->paths_of_a_sample()
                                                : std::numeric_limits<double>::infinity();
  if (e > 0.0) paths = std::min(paths, probe->variance / (e * e));
  goal.rays = paths * probe->rays * pixels;
  const double seconds = goal.rays / rays_a_second;
  if (!(goal.cpu_seconds > 0.0)) goal.cpu_seconds = seconds;
  goal.cpu_seconds = std::min(goal.cpu_seconds, seconds);
  goal.rays = goal.cpu_seconds * rays_a_second;
  return goal;
}

double rays_of(const SamplingGoal& sampling, const PixelWindow& window, int threads) {
  // A sample takes about three rays; its variance is a tenth of the square of its mean.
  constexpr double rays_of_a_sample = 3.0, variance = 0.1;
  const double e = sampling.relative_error;
  double samples = sampling.samples_per_pixel > 0 ? sampling.samples_per_pixel : infinity_f;
  if (e > 0.0) samples = std::min(samples, variance / (e * e));
  double rays = samples * rays_of_a_sample * window.size.x * window.size.y;
  if (sampling.seconds > 0.0) rays = std::min(rays, sampling.seconds * threads * rays_a_second);
  return std::isfinite(rays) ? rays : 0.0;
}

BiasGoal bias_goal(const SamplingGoal& sampling, const PixelWindow& window, int threads) {
  // Where the number of samples is not known, 8, as many as a noise of a few percent may need.
  SamplingGoal guessed = sampling;
  guessed.relative_error = 0.0;
  if (guessed.samples_per_pixel == 0) guessed.samples_per_pixel = 8;
  BiasGoal goal;
  if (sampling.relative_error > 0.0) goal.most = std::clamp(sampling.relative_error / 6.0, 0.001, goal.most);
  goal.rays = 0.5 * certificate_share * rays_of(guessed, window, threads);
  goal.seconds = share_of_pass_one * sampling.seconds;
  return goal;
}

PreparedPassOne prepare_within_bias(PassOneJob job, const Camera& camera, const PixelWindow& window,
                                    const PathLimits& limits, const BiasGoal& goal,
                                    const std::function<void(const std::string&)>& say) {
  // So that the samples are neither the picture's nor those of its certificate.
  constexpr std::uint32_t own_seeds = 0x6b79d8a1u;
  constexpr int most_refinements = 2;
  int refinements = goal.may_solve_again && !job.solved ? most_refinements : 0;
  std::optional<CausticParticles> particles;
  PreparedPassOne done = prepare({.scene = job.scene,
                                  .plan = job.plan,
                                  .integrator = job.integrator,
                                  .radiosity = job.radiosity,
                                  .solved = std::move(job.solved),
                                  .picture_rays = job.picture_rays},
                                 particles);
  for (std::uint32_t round = 0; done.solution; ++round) {
    const auto biased = make_integrator(IntegratorKind::two_pass, job.scene, done.view(), limits);
    const Truth truth(job.scene, done, limits, goal.rays);
    const std::optional<Certificate> found = certify({.biased = *biased,
                                                      .unbiased = truth.integrator(),
                                                      .camera = camera,
                                                      .width = window.size.x,
                                                      .height = window.size.y,
                                                      .corner = window.corner,
                                                      .seed = job.radiosity.seed + own_seeds * (round + 1),
                                                      .most_rays = truth.rays_left(),
                                                      .close_enough = 0.3 * goal.most,
                                                      .elements = done.solution->mesh().count()});
    if (!found || !found->is_certainly_beyond(goal.most)) return done;
    const std::string text = words_for(*found);
    const Elapsed spent = done.time();
    const std::size_t before = done.solution->mesh().count();
    if (refinements-- > 0 && (goal.seconds <= 0.0 || 3.0 * spent.seconds <= goal.seconds) &&
        refine(job, *found, goal.most, *particles, done)) {
      if (!done.solution) break;
      say(text + std::to_string(done.solution->mesh().count()) + " elements instead of " +
          std::to_string(before) + ", finer where paths found light that was not right");
    } else if (!done.gathers_twice) {
      done.field.reset();
      done.gathers_twice = true;
      say(text + "nothing is looked up, and gathering goes over one more surface");
    } else {
      say(text + "paths are traced without pass one");
      PreparedPassOne paths;
      paths.solution_time = spent;
      paths.left_out = "the picture would be biased by more than it may be";
      return paths;
    }
  }
  return done;
}

std::optional<Certificate> certify_picture(const CertifiedPicture& picture) {
  const Truth truth(picture.scene, picture.pass_one, picture.limits,
                    certificate_share * static_cast<double>(picture.counts.rays + picture.counts.shadow_rays));
  std::optional<Certificate> found = certify({.biased = picture.integrator,
                                              .unbiased = truth.integrator(),
                                              .camera = picture.camera,
                                              .width = picture.window.size.x,
                                              .height = picture.window.size.y,
                                              .corner = picture.window.corner,
                                              .seed = picture.seed,
                                              .most_rays = truth.rays_left()});
  if (!found || !std::isfinite(found->mean)) return std::nullopt;
  found->counts.rays += truth.rays_spent();
  return found;
}

}  // namespace twopass
