#include "tests/stress/picture.h"

#include <algorithm>
#include <cmath>

#include "render/pass_one.h"
#include "render/scene/centred_scene.h"
#include "render/scene/duplicate_lamps.h"
#include "render/stopwatch.h"

namespace twopass::stress {

namespace {

CameraDescription camera_of(const SceneDescription& description) {
  if (description.camera) return *description.camera;
  const Box3f bounds = bounds_of(description.shapes);
  const V3d eye = bounds.isEmpty() ? V3d(0.0) : (V3d(bounds.min) + V3d(bounds.max)) / 2.0;
  CameraDescription camera;
  camera.to_world = look_at({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, "camera");
  for (int axis = 0; axis < 3; ++axis) camera.to_world[3][axis] = eye[axis];
  camera.fov_degrees = 100.0;
  return camera;
}

void measure(const Film& film, Picture& picture) {
  const double values = 3.0 * film.width() * film.height();
  double variance = 0.0;
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x) {
      const FilmPixel& pixel = film.pixel(x, y);
      const C3d mean = pixel.mean();
      for (int c = 0; c < 3; ++c) {
        picture.mean += mean[c] / values;
        picture.brightest = std::max(picture.brightest, mean[c]);
      }
      if (pixel.batches < 2) continue;
      // Channels go up and down together: their errors are added, not their variances.
      const double spread = std::sqrt(pixel.spread.x) + std::sqrt(pixel.spread.y) + std::sqrt(pixel.spread.z);
      variance += spread * spread / ((pixel.batches - 1) * static_cast<double>(pixel.samples));
    }
  picture.error = std::sqrt(variance) / values;
}

// With the elements and the method that are asked for, and whatever bias comes of them.
PreparedPassOne asked_pass_one(const Scene& scene, const Camera& camera, const Plan& plan, const Way& way,
                               const PictureOptions& options) {
  RadiosityOptions radiosity;
  radiosity.solver = way.solver;
  radiosity.form_factors = way.form_factors;
  radiosity.max_elements = options.elements;
  radiosity.rays_per_element = options.rays_per_element;
  radiosity.hemicube_resolution = 16;
  radiosity.seed = options.seed;
  const PixelWindow window{{0, 0}, {options.width, options.height}};
  return prepare_pass_one(
      {.scene = scene,
       .plan = plan,
       .integrator = way.integrator,
       .radiosity = radiosity_options(way.integrator, options.limits, camera, window, radiosity)});
}

// As `twopass render` does that is told nothing of it.
PreparedPassOne chosen_pass_one(const Scene& scene, const Camera& camera, Plan& plan, IntegratorKind integrator,
                                const PictureOptions& options) {
  const PixelWindow window{{0, 0}, {options.width, options.height}};
  const SamplingGoal sampling{options.samples, 0.0, 0.0};
  const std::optional<ViewProbe> probe = fit_to_view(plan, integrator, scene, camera, window, options.limits,
                                                     options.seed, rays_of(sampling, window, 1));
  const PictureGoal goal = picture_goal(sampling, window, 1, probe);
  RadiosityOptions radiosity;
  radiosity.seed = options.seed;
  PassOneJob job{.scene = scene,
                 .plan = plan,
                 .integrator = integrator,
                 .radiosity = radiosity_options(integrator, options.limits, camera, window, radiosity, goal),
                 .picture_rays = goal.rays};
  if (!plan.radiosity_pass || integrator != IntegratorKind::two_pass) return prepare_pass_one(std::move(job));
  return prepare_within_bias(std::move(job), camera, window, options.limits, bias_goal(sampling, window, 1),
                             [](const std::string&) {});
}

}  // namespace

std::string name_of(const Way& way) {
  std::string name(name_of_value<IntegratorKind>(integrator_names, way.integrator));
  if (way.solver != Solver::automatic) name.append("_").append(name_of_value<Solver>(solver_names, way.solver));
  if (way.form_factors != FormFactorMethod::automatic)
    name.append("_").append(name_of_value<FormFactorMethod>(form_factor_method_names, way.form_factors));
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

std::vector<Way> all_integrators() {
  std::vector<Way> ways;
  for (const auto& [name, integrator] : integrator_names) ways.push_back({integrator});
  return ways;
}

std::vector<Way> all_ways() {
  std::vector<Way> ways = all_integrators();
  for (const auto& [name, solver] : solver_names)
    if (solver != Solver::automatic) ways.push_back({IntegratorKind::radiosity, solver});
  for (const auto& [name, method] : form_factor_method_names)
    if (method != FormFactorMethod::automatic)
      ways.push_back({IntegratorKind::radiosity, Solver::automatic, method});
  return ways;
}

Picture render(const SceneDescription& description, const Way& way, const PictureOptions& options) {
  const Stopwatch stopwatch;
  Picture picture;
  Plan plan = plan_render(needs_of(description), way.integrator, options.limits);
  SceneDescription local = description;
  local.camera = camera_of(description);
  leave_out_duplicate_lamps(local);
  const Scene scene(centred(std::move(local)));
  const Camera camera(*scene.description().camera, options.width, options.height);
  const PreparedPassOne pass_one = options.elements == 0
                                       ? chosen_pass_one(scene, camera, plan, way.integrator, options)
                                       : asked_pass_one(scene, camera, plan, way, options);
  if (pass_one.solution) picture.notes = pass_one.solution->stats().notes;
  const auto integrator = make_integrator(way.integrator, scene, pass_one.view(), options.limits);
  Film film(options.width, options.height);
  picture.outcome = render_image({.integrator = *integrator,
                                  .camera = camera,
                                  .filter = box_filter(),
                                  .goal = {options.samples, 0.0, 0.0},
                                  .seed = options.seed,
                                  .sampler = options.sampler},
                                 film);
  picture.image = film.resolve();
  measure(film, picture);
  picture.cpu_seconds = stopwatch.elapsed().cpu_seconds;
  return picture;
}

std::string fault_of(const Picture& picture) {
  if (picture.outcome.non_finite_samples > 0) {
    const SamplePlace& place = *picture.outcome.first_non_finite;
    return std::to_string(picture.outcome.non_finite_samples) + " samples are not finite, the first: sample " +
           std::to_string(place.sample) + " of pixel " + std::to_string(place.pixel.x) + "," +
           std::to_string(place.pixel.y);
  }
  for (std::size_t i = 0; i < picture.image.pixels.size(); ++i) {
    const float value = picture.image.pixels[i];
    const bool is_alpha = i % 4 == 3;
    if (!(value >= 0.0f && value <= (is_alpha ? 1.0f : std::numeric_limits<float>::max())))
      return "value " + std::to_string(i % 4) + " of pixel " + std::to_string(i / 4) + " is " +
             std::to_string(value);
  }
  return {};
}

}  // namespace twopass::stress
