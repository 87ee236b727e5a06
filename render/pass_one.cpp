#include "render/pass_one.h"

namespace twopass {

namespace {

// A guide costs about this many rays: where fewer are to be cast, it would only cost.
constexpr double rays_of_guide = 1e6;

// Of the time that a picture may take, and what pass one costs for each pixel of it, look-ups included:
// measured in the scenes of scenes/ (2 to 4 microseconds of CPU).
constexpr double share_of_pass_one = 0.15, seconds_of_a_pixel = 3e-6;

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

// Gathering is guided where indirect light is not looked up. With fewer rays a bin the guide is worse than none
// where light comes through a crack; fewer cells than for paths, of which only the first direction is gathered.
GuideOptions guide_options(const PassOneJob& job, const PreparedPassOne& done) {
  GuideOptions options;
  options.seed = job.radiosity.seed;
  if (job.integrator != IntegratorKind::two_pass) return options;
  options.rays_per_bin = 16;
  options.max_cells = 1024;
  if (!done.field) return options;
  for (std::uint32_t e = 0; e < done.solution->mesh().count(); ++e)
    options.wanted.push_back(done.field->known(e) < Known::indirect);
  return options;
}

}  // namespace

RadiosityOptions radiosity_options(IntegratorKind integrator, const PathLimits& limits, const Camera& camera,
                                   const PixelWindow& window, RadiosityOptions asked, double cpu_seconds) {
  asked.max_reflections = max_reflections_of(integrator, limits);
  if (integrator != IntegratorKind::two_pass) return asked;
  asked.gathered_pixels = static_cast<std::size_t>(camera.width()) * static_cast<std::size_t>(camera.height());
  if (cpu_seconds > 0.0) {
    const auto affordable = static_cast<std::size_t>(share_of_pass_one * cpu_seconds / seconds_of_a_pixel);
    asked.gathered_pixels = std::clamp<std::size_t>(affordable, 1, asked.gathered_pixels);
  }
  asked.view = view_rays(camera, window, asked.seed);
  return asked;
}

PreparedPassOne prepare_pass_one(PassOneJob job) {
  PreparedPassOne done;
  if (!job.plan.radiosity_pass) return done;
  Stopwatch stopwatch;
  done.solution = std::make_unique<const Solution>(job.solved ? std::move(*job.solved)
                                                              : solve_radiosity(job.scene, job.radiosity));
  done.solution_time = stopwatch.elapsed();
  if (job.plan.indirect_field) {
    stopwatch = Stopwatch();
    IndirectFieldOptions options;
    options.seed = job.radiosity.seed;
    done.field = std::make_unique<const IndirectField>(job.scene, *done.solution, options);
    done.field_time = stopwatch.elapsed();
  }
  if (job.plan.guide) {
    stopwatch = Stopwatch();
    done.guide = std::make_unique<const Guide>(job.scene, *done.solution, guide_options(job, done));
    done.guide_time = stopwatch.elapsed();
  }
  return done;
}

std::optional<Certificate> certify_picture(const CertifiedPicture& picture) {
  const double rays = certificate_share * static_cast<double>(picture.counts.rays + picture.counts.shadow_rays);
  PassOne pass_one = picture.pass_one.view();
  std::optional<Guide> own;
  // What a two-pass picture has is only for where it gathers.
  if (rays > 2.0 * rays_of_guide) pass_one.guide = &own.emplace(picture.scene, *pass_one.solution);
  // What clamps do to the picture is part of its bias.
  PathLimits limits = picture.limits;
  limits.clamp_direct = limits.clamp_indirect = infinity_f;
  const std::unique_ptr<Integrator> truth =
      make_integrator(IntegratorKind::unbiased, picture.scene, pass_one, limits);
  return certify({.biased = picture.integrator,
                  .unbiased = *truth,
                  .camera = picture.camera,
                  .width = picture.window.size.x,
                  .height = picture.window.size.y,
                  .corner = picture.window.corner,
                  .seed = picture.seed,
                  .most_rays = rays});
}

}  // namespace twopass
