// twopass render: one picture.
#include <cstdio>

#include "radiosity/scene_fingerprint.h"
#include "radiosity/solution_file.h"
#include "render/commands/command.h"
#include "render/commands/picture_outputs.h"
#include "render/commands/render_options.h"
#include "render/commands/render_report.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/image/atomic_file.h"
#include "render/image/picture.h"
#include "render/pass_one.h"
#include "render/render_identity.h"
#include "render/statistics.h"
#include "render/version.h"
#include "render/view_probe.h"

namespace twopass {

namespace {

std::string reflections_text(int max_reflections) {
  return max_reflections < 0 ? "any number of reflections"
                             : "at most " + std::to_string(max_reflections) + " reflections";
}

// A solution of other paths than this render's would be a picture of neither.
Solution load_fitting_solution(const Scene& scene, const std::string& file, int max_reflections,
                               GroupedIrradiance& groups) {
  Solution solution = load_solution(file, scene, &groups);
  const int held = solution.stats().max_reflections;
  if (held != max_reflections)
    throw Error(file,
                "it holds light of " + reflections_text(held) + ", this render needs that of " +
                    reflections_text(max_reflections),
                "make it again with twopass solve --max-reflections " + std::to_string(max_reflections) +
                    ", or change --max-depth");
  return solution;
}

// Pass one, with what the user should know about it.
PreparedPassOne run_pass_one(const Scene& scene, const Camera& camera, const RenderOptions& options,
                             const RenderSettings& settings, const SamplingGoal& goal, Plan& plan,
                             const RadiosityOptions& radiosity, double picture_rays, const Console& console,
                             RenderStatistics& statistics, GroupedIrradiance& stored_groups) {
  PassOneJob job{.scene = scene,
                 .plan = plan,
                 .integrator = settings.integrator,
                 .radiosity = radiosity,
                 .picture_rays = picture_rays};
  Elapsed load_time;
  if (!plan.radiosity_pass) {
    for (const Skipped& skipped : plan.skipped)
      if (!options.solution_file.empty() && skipped.what == "radiosity pass")
        console.note(options.solution_file + ": not needed, because " + skipped.why);
  } else if (!options.solution_file.empty()) {
    const Stopwatch stopwatch;
    job.solved =
        load_fitting_solution(scene, options.solution_file, job.radiosity.max_reflections, stored_groups);
    load_time = stopwatch.elapsed();
  }
  const bool is_judged = options.certificate && plan.radiosity_pass &&
                         settings.integrator == IntegratorKind::two_pass && !is_clamped(settings.limits);
  PreparedPassOne done =
      is_judged ? prepare_within_bias(std::move(job), camera, {{0, 0}, {settings.width, settings.height}},
                                      settings.limits, bias_goal(goal, settings.window, statistics.threads),
                                      [&](const std::string& step) { console.note(step); })
                : prepare_pass_one(std::move(job));
  if (plan.radiosity_pass && !done.solution) {
    statistics.radiosity_time = done.time();
    plan.skipped.push_back({"radiosity pass", done.left_out});
    console.note("radiosity pass: left out, because " + done.left_out);
  }
  if (!done.solution) return done;
  const RadiosityStats& stats = done.solution->stats();
  done.solution_time = done.solution_time + load_time;
  statistics.radiosity_time = done.time();
  statistics.radiosity = stats;
  for (const std::string& note : stats.notes) console.note(note);
  if (!options.solution_file.empty()) console.note("radiosity pass: taken from " + options.solution_file);
  char text[200];
  std::snprintf(text, sizeof text, "radiosity: %zu elements, %s, %s, %zu iterations, error bound %.2g, %.2f s",
                stats.elements, stats.form_factors.c_str(), stats.solver.c_str(), stats.iterations,
                stats.error_bound, done.solution_time.seconds);
  console.note(text);
  if (done.field) {
    std::snprintf(
        text, sizeof text,
        "light: indirect looked up on %.0f %% of the area, with direct on %.0f %%, gathered elsewhere, "
        "%.2f s",
        100.0 * done.field->share(Known::indirect), 100.0 * done.field->share(Known::all),
        done.field_time.seconds);
    console.note(text);
  }
  return done;
}

bool wants_half(const RenderOptions& options, const FileSettings& file) {
  return options.exr_type.empty() ? file.half.value_or(true) : options.exr_type == "half";
}

// What is left of a goal of time for pass two, and after it for the certificate.
SamplingGoal left_of(SamplingGoal goal, const Elapsed& pass_one, bool is_certified) {
  if (goal.seconds > 0.0)
    goal.seconds =
        std::max(goal.seconds - pass_one.seconds, 1e-3) * (is_certified ? 1.0 - certificate_share : 1.0);
  return goal;
}

// The light of the solution by light group, stored with it or solved now. Its time is part of pass one.
std::optional<GroupedLight> group_solution(const Scene& scene, const std::optional<LightGroups>& groups,
                                           GroupedIrradiance stored, const PreparedPassOne& pass_one,
                                           const RadiosityOptions& radiosity, const Console& console,
                                           RenderStatistics& statistics) {
  if (!groups || !pass_one.solution) return std::nullopt;
  const Stopwatch stopwatch;
  IndirectFieldOptions field_options;
  field_options.seed = radiosity.seed;
  const bool is_stored = stored.names == groups->names();
  if (!is_stored) stored = solve_by_group(scene, *groups, *pass_one.solution, radiosity);
  std::optional<GroupedLight> grouped;
  grouped.emplace(scene, *pass_one.solution, std::move(stored), pass_one.field != nullptr, field_options);
  const Elapsed elapsed = stopwatch.elapsed();
  statistics.radiosity_time += elapsed;
  char text[120];
  std::snprintf(text, sizeof text, "light groups: %zu, %s, %.2f s", groups->size(),
                is_stored ? "taken from the solution's file" : "each solved by itself", elapsed.seconds);
  console.note(text);
  return grouped;
}

// Says before any work what a large picture needs; throws Error when there is not so much.
void check_memory(const V2i& size, const FilmLayout& layout, const Console& console) {
  Film::check(size.x, size.y, layout);
  if (const double bytes = Film::bytes_to_render(size.x, size.y, layout); bytes > 1e9)
    console.note("the picture needs " + std::to_string(static_cast<int>(std::ceil(bytes / 1e9))) +
                 " GB of memory, however many samples it has");
}

// What the colours are in, for readers of the file.
void settle_space(const WorkingSpace& space, ExrOptions& exr) {
  exr.color_space = space.interop_id.empty() ? unknown_space : space.interop_id;
  if (space.interop_id.empty()) exr.primaries = primaries_of(space.to_rec709);
  if (!space.is_rec709()) exr.metadata.emplace_back(working_space_metadata, space.name);
}

ExrOptions exr_options(const RenderOptions& options, const FileSettings& file, const RenderSettings& settings,
                       const RenderStatistics& s) {
  ExrOptions exr;
  options.layers.settle(options.layers.request(), exr);
  exr.data_offset = settings.window.corner;
  exr.display_size = V2i(settings.width, settings.height);
  exr.pixel_type = wants_half(options, file) ? PixelType::half : PixelType::float_;
  const double pixels = static_cast<double>(s.width) * s.height;
  exr.metadata = {{"twopass/version", std::string(program_version)},
                  {"twopass/scene", s.scene_file},
                  {"twopass/integrator", s.integrator},
                  {"twopass/spp", static_cast<float>(static_cast<double>(s.samples) / pixels)},
                  {"twopass/seed", static_cast<int>(s.seed)},
                  {"twopass/stopReason", s.outcome.stop_reason}};
  if (options.layers.overscan > 0) exr.metadata.emplace_back(overscan_metadata, options.layers.overscan);
  if (!s.clamped.empty()) exr.metadata.emplace_back("twopass/bias", s.clamped);
  if (s.bias) {
    exr.metadata.emplace_back("twopass/biasMean", static_cast<float>(s.bias->mean));
    exr.metadata.emplace_back("twopass/biasCi95", static_cast<float>(s.bias->ci95));
  }
  return exr;
}

int render(const RenderOptions& options, const GlobalOptions& global) {
  const Console console = global.console();
  const Stopwatch total;
  RenderStatistics s;
  // What can go wrong with the outputs goes wrong before any work is done.
  const WorkingSpace space = find_working_space(options.display.working_space, options.display.config);
  PictureOutputs pictures(options.outputs, options.display);
  if (!options.stats_file.empty()) check_writable(options.stats_file);
  const LayerRequest layer_request = options.layers.request();
  {
    ExrOptions exr;
    options.layers.settle(layer_request, exr);
    options.layers.check(layer_request, options.outputs, exr);
  }
  LongRender parts(options.parts, console);
  const ThreadLimit limit(global.threads);
  if (options.layers.denoise) {
    if (parts.is_slice())
      throw Error("--denoise", "a slice has the noise that the others take out",
                  "give --aov denoise here, and --denoise to twopass merge");
    pictures.set_denoiser(global.threads);
  }

  Stopwatch stopwatch;
  LoadedScene loaded =
      options.scene.load(console, SceneOptions::Additions::light_and_camera, options.display.config);
  RenderSettings settings = settle(options, loaded.settings, console);
  // What a picture is judged by must not depend on how it is divided, nor on when it was to end at first.
  SamplingGoal judged_by = settings.goal;
  if (!options.parts.checkpoint.empty() || !options.parts.resume.empty()) judged_by = {};
  parts.divide(settings.goal);
  if (!space.is_rec709()) put_in_primaries(loaded.scene, space.from_rec709);
  const SceneNeeds needs = needs_of(loaded.scene);
  Plan plan = plan_render(needs, settings.integrator, settings.limits);
  if (!needs.light)
    console.note(options.scene.file +
                 ": the scene has no light, the picture will be black (--sky 1,1,1 adds a sky)");
  s.load = stopwatch.elapsed();

  stopwatch = Stopwatch();
  const CameraDescription camera_description = *loaded.scene.camera;
  const Scene scene(std::move(loaded.scene));
  s.build = stopwatch.elapsed();

  s.threads = limit.threads();
  const Camera camera(camera_description, settings.width, settings.height);
  std::optional<LightGroups> groups;
  if (layer_request.light_groups) groups.emplace(light_groups_of(scene));
  const FilmLayout layout =
      layout_of(layer_request, groups ? &*groups : nullptr, loaded.settings.filter.table != nullptr);
  check_memory(settings.window.size, layout, console);
  // Of the whole picture, so that a part of it is the same bits.
  const PixelWindow whole{{0, 0}, {settings.width, settings.height}};
  const std::optional<ViewProbe> probe =
      fit_to_view(plan, settings.integrator, scene, camera, whole, settings.limits, settings.seed,
                  rays_of(judged_by, whole, s.threads), !options.solution_file.empty());
  for (const Skipped& skipped : plan.skipped)
    console.detail("skipped: " + skipped.what + ", because " + skipped.why);
  const PictureGoal picture = picture_goal(judged_by, whole, s.threads, probe);
  const RadiosityOptions radiosity = radiosity_options(settings.integrator, settings.limits, camera, whole,
                                                       options.radiosity.settle(settings.seed), picture);
  GroupedIrradiance stored_groups;
  const PreparedPassOne pass_one = run_pass_one(scene, camera, options, settings, judged_by, plan, radiosity,
                                                picture.rays, console, s, stored_groups);
  const std::optional<GroupedLight> grouped =
      group_solution(scene, groups, std::move(stored_groups), pass_one, radiosity, console, s);

  const bool is_certified =
      pass_one.solution && options.certificate && settings.integrator == IntegratorKind::two_pass;
  const SamplingGoal goal = left_of(settings.goal, pass_one.time(), is_certified);

  stopwatch = Stopwatch();
  const Layers layers(layer_request, scene, camera_description, pass_one.solution.get(),
                      groups ? &*groups : nullptr, grouped ? &*grouped : nullptr);
  Film film(settings.window.size.x, settings.window.size.y, layout);
  const std::unique_ptr<Integrator> integrator =
      make_integrator(settings.integrator, scene, pass_one.view(), settings.limits);
  const RayCone cone = scene.has_textures()
                           ? sample_cone(camera, settings.width, settings.height, parts.footprint_samples())
                           : RayCone{};
  parts.begin(identity_of({.scene = scene,
                           .solution = pass_one.solution ? &*pass_one.solution : nullptr,
                           .integrator = settings.integrator,
                           .limits = settings.limits,
                           .size = {settings.width, settings.height},
                           .window = settings.window,
                           .filter = loaded.settings.filter,
                           .sampler = settings.sampler,
                           .strata = parts.all_samples(),
                           .seed = settings.seed,
                           .camera = camera_description,
                           .cone = cone,
                           .layout = film.layout()}),
              film);
  s.scene_file = options.scene.file;
  s.count(scene);
  s.integrator = name_of_value<IntegratorKind>(integrator_names, settings.integrator);
  s.clamped = clamp_text(settings.limits);
  s.sampler = name_of_value<SamplerKind>(sampler_names, settings.sampler);
  s.width = settings.window.size.x;
  s.height = settings.window.size.y;
  s.seed = settings.seed;
  s.outcome.stop_reason = "not yet";

  char fingerprint[17];
  std::snprintf(fingerprint, sizeof fingerprint, "%016llx",
                static_cast<unsigned long long>(scene_fingerprint(scene)));
  const std::function<ExrOptions(const RenderState&)> options_of_picture = [&](const RenderState& state) {
    s.samples = film.samples();
    s.outcome.counts = state.costs.counts;
    ExrOptions exr = exr_options(options, loaded.settings, settings, s);
    settle_space(space, exr);
    const CameraDescription in_world = scene.description().frame.to_world(camera_description);
    exr.world_to_camera = M44f(world_to_camera(in_world));
    exr.world_to_ndc = M44f(world_to_ndc(in_world, settings.width, settings.height));
    exr.metadata.emplace_back("twopass/sceneFingerprint", std::string(fingerprint));
    exr.metadata.emplace_back("twopass/ocio", pictures.color_text());
    for (const auto& [name, value] : layers.cryptomatte_metadata()) exr.metadata.emplace_back(name, value);
    if (options.layers.seconds)
      exr.metadata.emplace_back("twopass/seconds", static_cast<float>(stopwatch.seconds()));
    return exr;
  };
  // All of them, even when one of them fails: then throws its Error.
  const std::function<void(const RenderState&)> write_pictures = [&](const RenderState& state) {
    const ExrOptions exr = options_of_picture(state);
    pictures.write(film.resolve_all(), exr, [&](const std::string& path) {
      const bool is_part = parts.is_slice() && !is_display_referred(path);
      if (is_part) parts.save(path, film, state, exr);
      return is_part;
    });
  };
  {
    Progress progress(console, "rendering");
    RenderJob job{.integrator = *integrator,
                  .camera = camera,
                  .filter = loaded.settings.filter,
                  .goal = goal,
                  .seed = settings.seed,
                  .sampler = settings.sampler,
                  .cone = cone,
                  .corner = settings.window.corner,
                  .layers = layer_request.empty() ? nullptr : &layers};
    if (console.verbosity() != Verbosity::quiet)
      job.report_progress = [&](const RenderProgress& at) {
        progress.update(at.fraction, [&] { return progress_text(at); });
      };
    parts.prepare(job, film, options.outputs.front(), space.to_rec709, write_pictures, options_of_picture);
    s.outcome = render_image(job, film);
    parts.end_preview();
  }
  if (is_certified) {
    s.bias = certify_picture({.scene = scene,
                              .pass_one = pass_one,
                              .integrator = *integrator,
                              .limits = settings.limits,
                              .camera = camera,
                              .window = settings.window,
                              .seed = settings.seed,
                              .counts = s.outcome.counts});
    s.bias_not_measured = !s.bias && !interrupt_requested();
  }
  s.render = stopwatch.elapsed();
  note_tiled_textures(console, loaded.tiled_textures);

  s.skipped = plan.skipped;
  s.skipped.insert(s.skipped.end(), loaded.left_out.begin(), loaded.left_out.end());
  s.samples = film.samples();
  const NoiseEstimate noise = film.noise();
  s.relative_error = std::sqrt(noise.relmse);
  s.relative_error_bound = noise.upper_bound();

  if (s.samples == 0) throw Interrupted{};  // an older picture is better than an empty one
  stopwatch = Stopwatch();
  const RenderState state{s.outcome.plan, {s.outcome.counts, s.outcome.non_finite_samples}};
  std::exception_ptr failure;
  try {
    parts.finish(film, state, options_of_picture(state));
  } catch (const Error&) {
    failure = std::current_exception();
  }
  write_pictures(state);
  if (failure) std::rethrow_exception(failure);
  s.write = stopwatch.elapsed();
  s.total = total.elapsed();
  if (!options.stats_file.empty()) write_statistics(options.stats_file, s);
  report_render(options.outputs, s, console);
  if (s.outcome.stop_reason != "interrupted") return 0;
  console.note("interrupted: wrote what there was");
  return exit_interrupted();
}

}  // namespace

void add_render_command(CLI::App& program, const GlobalOptions& global, Action& action) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App& command = *program.add_subcommand("render", "Render one picture");
  options->add_to(command);
  command.callback(
      [options, &global, &action] { action = [options, &global] { return render(*options, global); }; });
}

}  // namespace twopass
