// twopass render: one picture.
#include <cstdio>

#include "integrators/clamp.h"
#include "radiosity/scene_fingerprint.h"
#include "radiosity/solution_file.h"
#include "render/commands/command.h"
#include "render/commands/display_options.h"
#include "render/commands/layer_options.h"
#include "render/commands/long_render.h"
#include "render/commands/picture_outputs.h"
#include "render/commands/radiosity_options.h"
#include "render/commands/scene_options.h"
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

constexpr double default_noise = 0.03;

struct RenderOptions {
  SceneOptions scene;
  std::vector<std::string> outputs;
  std::string integrator, sampler, size, stats_file, exr_type;
  std::vector<int> crop;  // left, top, width, height
  SamplingGoal goal;
  std::optional<int> max_depth;
  float clamp_direct = infinity_f, clamp_indirect = infinity_f;
  std::optional<std::uint32_t> seed;
  RadiosityCommandOptions radiosity;
  std::string solution_file;
  DisplayOptions display;
  LayerOptions layers;
  bool certificate = true;
  LongRenderOptions parts;
};

// The settings of the file with the command line's put over them.
struct Settings {
  IntegratorKind integrator = IntegratorKind::two_pass;
  PathLimits limits;
  int width = 0, height = 0;
  PixelWindow window;  // the part of it that is rendered
  SamplingGoal goal;
  SamplerKind sampler = SamplerKind::sobol;
  std::uint32_t seed = 0;
};

void parse_size(const std::string& text, Settings& settings) {
  int consumed = 0;
  if (std::sscanf(text.c_str(), "%dx%d%n", &settings.width, &settings.height, &consumed) != 2 ||
      consumed != static_cast<int>(text.size()) || settings.width < 1 || settings.height < 1)
    throw Error("--size " + text, "not a picture size", "write WIDTHxHEIGHT in pixels, for example 640x480");
}

// The part of the picture to render: --crop, else the file's window, which keeps its place in a picture of
// another size, else all.
PixelWindow window_of(const RenderOptions& options, const FileSettings& file, const V2i& size) {
  if (!options.crop.empty()) {
    const PixelWindow window{{options.crop[0], options.crop[1]}, {options.crop[2], options.crop[3]}};
    for (int axis = 0; axis < 2; ++axis)
      if (window.corner[axis] < 0 || window.size[axis] < 1 ||
          window.corner[axis] > size[axis] - window.size[axis])
        throw Error(
            "--crop", "the window reaches beyond the picture",
            "give LEFT,TOP,WIDTH,HEIGHT inside of " + std::to_string(size.x) + "x" + std::to_string(size.y));
    return window;
  }
  if (!file.crop) return {{0, 0}, size};
  PixelWindow window;
  const V2i file_size(file.width, file.height);
  for (int axis = 0; axis < 2; ++axis) {
    const double scale = static_cast<double>(size[axis]) / file_size[axis];
    const int begin = file.crop->corner[axis], end = begin + file.crop->size[axis];
    window.corner[axis] = static_cast<int>(begin * scale);
    window.size[axis] = std::min(static_cast<int>(std::ceil(end * scale)), size[axis]) - window.corner[axis];
  }
  return window;
}

Settings settle(const RenderOptions& options, const FileSettings& file, const Console& console) {
  Settings settings;
  if (!options.integrator.empty())
    settings.integrator =
        value_of_name<IntegratorKind>(integrator_names, options.integrator, "--integrator", "integrator");
  else if (file.integrator)
    settings.integrator =
        value_of_name<IntegratorKind>(integrator_names, *file.integrator, options.scene.file, "integrator");
  // The sampler of the file is no wish: nearly all files name Mitsuba's default, which is the noisiest.
  if (!options.sampler.empty())
    settings.sampler = value_of_name<SamplerKind>(sampler_names, options.sampler, "--sampler", "sampler");
  settings.limits = {options.max_depth.value_or(file.max_depth), file.rr_depth, file.hide_emitters,
                     options.clamp_direct, options.clamp_indirect};
  settings.width = file.width;
  settings.height = file.height;
  if (!options.size.empty()) parse_size(options.size, settings);
  settings.window = window_of(options, file, {settings.width, settings.height});
  const int overscan = options.layers.overscan;
  settings.window.corner -= V2i(overscan, overscan);
  settings.window.size += V2i(2 * overscan, 2 * overscan);
  settings.goal = options.goal;
  const bool has_goal =
      settings.goal.samples_per_pixel > 0 || settings.goal.seconds > 0.0 || settings.goal.relative_error > 0.0;
  if (!has_goal && file.samples_per_pixel) settings.goal.samples_per_pixel = *file.samples_per_pixel;
  if (!has_goal && !file.samples_per_pixel) {
    settings.goal.relative_error = default_noise;
    console.note("rendering until the estimated relative error is " +
                 std::to_string(default_noise).substr(0, 4) + " (--spp, --time or --noise override)");
  }
  settings.seed = options.seed.value_or(file.seed.value_or(0));
  return settings;
}

// What the clamps do to the picture, in words; empty without them.
std::string clamp_text(const PathLimits& limits) {
  std::string text;
  const auto add = [&](const char* what, float most) {
    if (most == infinity_f) return;
    char part[60];
    std::snprintf(part, sizeof part, "%s%s light clamped to %g", text.empty() ? "" : ", ", what, most);
    text += part;
  };
  add("direct", limits.clamp_direct);
  add("indirect", limits.clamp_indirect);
  return text;
}

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
                             const Settings& settings, const SamplingGoal& goal, Plan& plan,
                             const RadiosityOptions& radiosity, const Console& console,
                             RenderStatistics& statistics, GroupedIrradiance& stored_groups) {
  PassOneJob job{.scene = scene, .plan = plan, .integrator = settings.integrator, .radiosity = radiosity};
  Elapsed load_time;
  if (!plan.radiosity_pass) {
    for (const Skipped& skipped : plan.skipped)
      if (!options.solution_file.empty() && skipped.what == "radiosity pass")
        console.note(options.solution_file + ": not needed, because " + skipped.why);
  } else if (!options.solution_file.empty()) {
    const Stopwatch stopwatch;
    job.solved = load_fitting_solution(scene, options.solution_file, job.radiosity.max_reflections,
                                       stored_groups);
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
    plan.skipped.push_back({"radiosity pass", "the picture would be biased by more than it may be"});
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

ExrOptions exr_options(const RenderOptions& options, const FileSettings& file, const Settings& settings,
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

void report(const RenderOptions& options, const RenderStatistics& s, const Console& console) {
  if (console.verbosity() == Verbosity::quiet) return;
  for (const std::string& output : options.outputs) std::printf("wrote %s\n", output.c_str());
  const double pixels = static_cast<double>(s.width) * s.height;
  std::printf("%s, %dx%d, %.4g samples a pixel (stopped by %s)", s.integrator.c_str(), s.width, s.height,
              static_cast<double>(s.samples) / pixels, s.outcome.stop_reason.c_str());
  if (std::isfinite(s.relative_error)) std::printf(", estimated noise %.3g", s.relative_error);
  if (s.outcome.pixels_stopped_early > 0.0)
    std::printf(", %.3g %% of the pixels stopped early", 100.0 * s.outcome.pixels_stopped_early);
  std::printf(", %.2f s (%.2f s CPU)\n", s.total.seconds, s.total.cpu_seconds);
  if (!s.clamped.empty()) std::printf("biased: %s W/(m2 sr) a path\n", s.clamped.c_str());
  if (s.bias)
    std::printf("bias of the picture's mean: %+.2f %% +- %.2f %% (95 %% confidence, %.2g samples)\n",
                100.0 * s.bias->mean, 100.0 * s.bias->ci95, static_cast<double>(s.bias->samples));
  if (s.bias_not_measured)
    std::printf("bias of the picture's mean: not measured, hardly any sample sees light that is looked up\n");
  // The estimate is worth as much as that of 16 equal pixels, or less: 1.22^2 = 1 + 2 / sqrt(16). Nobody sees
  // noise below a thousandth.
  if (std::isfinite(s.relative_error) && s.relative_error_bound > std::max(1e-3, 1.22 * s.relative_error)) {
    char text[200];
    std::snprintf(
        text, sizeof text,
        "few pixels hold most of the noise (rare bright samples): it may be as large as %.2g, or larger "
        "where such samples have not been met yet",
        s.relative_error_bound);
    console.note(text);
  }
  if (may_have_cracks(s.outcome.counts))
    console.note(s.scene_file + ": " + std::to_string(s.outcome.counts.escaped_rays) + " of " +
                 std::to_string(s.outcome.counts.rays) +
                 " rays left the scene: there are cracks between its surfaces, or openings as small");
  if (s.outcome.non_finite_samples > 0) {
    std::printf("%llu samples were not finite and counted as black",
                static_cast<unsigned long long>(s.outcome.non_finite_samples));
    if (const std::optional<SamplePlace>& place = s.outcome.first_non_finite)
      std::printf("; the first: sample %u of pixel %d,%d", place->sample, place->pixel.x, place->pixel.y);
    std::printf("\n");
  }
}

// "pass 3, 24 spp, noise 0.034, 5.1 Mrays/s"
std::string progress_text(const RenderProgress& at) {
  char noise[32] = "", text[160];
  if (std::isfinite(at.error)) std::snprintf(noise, sizeof noise, ", noise %.2g", at.error);
  std::snprintf(text, sizeof text, "pass %d, %.4g spp%s, %.3g Mrays/s", at.pass, at.samples_per_pixel, noise,
                1e-6 * at.rays_per_second);
  return text;
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
  LoadedScene loaded = options.scene.load(console, SceneOptions::Additions::light_and_camera, options.display.config);
  Settings settings = settle(options, loaded.settings, console);
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
  fit_to_view(plan, settings.integrator, scene, camera, whole, settings.limits, settings.seed,
              !options.solution_file.empty());
  for (const Skipped& skipped : plan.skipped)
    console.detail("skipped: " + skipped.what + ", because " + skipped.why);
  const RadiosityOptions radiosity =
      radiosity_options(settings.integrator, settings.limits, camera, whole,
                        options.radiosity.settle(settings.seed), settings.goal.seconds * s.threads);
  GroupedIrradiance stored_groups;
  const PreparedPassOne pass_one =
      run_pass_one(scene, camera, options, settings, judged_by, plan, radiosity, console, s, stored_groups);
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
  report(options, s, console);
  if (s.outcome.stop_reason != "interrupted") return 0;
  console.note("interrupted: wrote what there was");
  return exit_interrupted();
}

}  // namespace

void add_render_command(CLI::App& program, const GlobalOptions& global, Action& action) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App& command = *program.add_subcommand("render", "Render one picture");
  options->scene.add_to(command);
  options->scene.add_sky_to(command);
  options->scene.add_view_to(command);
  command
      .add_option("-o,--output", options->outputs,
                  "Picture to write (repeatable): .exr scene-linear; .png, .jpg, .tif display-referred")
      ->required()
      ->allow_extra_args(false);
  command.add_option("--integrator", options->integrator, "twopass, unbiased, path, radiosity or direct");
  command.add_option("--sampler", options->sampler,
                     "sobol (default, whatever the scene says), stratified or independent");
  command.add_option("--spp", options->goal.samples_per_pixel, "Stop at this many samples a pixel")
      ->check(CLI::Range(1, most_samples_per_pixel));
  command.add_option("--time", options->goal.seconds, "Stop after this many seconds, pass one included")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--noise", options->goal.relative_error,
                  "Stop at this estimated relative error, sampling more where there is more noise")
      ->check(CLI::PositiveNumber);
  command.add_option("--size", options->size, "Picture size, WIDTHxHEIGHT");
  command
      .add_option(
          "--crop", options->crop,
          "The part of the picture to render, LEFT,TOP,WIDTH,HEIGHT in pixels; .exr files remember its place")
      ->delimiter(',')
      ->expected(4);
  command.add_option("--max-depth", options->max_depth, "Most edges of a path; -1 unlimited, 2 direct light")
      ->check(CLI::Range(-1, 1 << 30));
  command
      .add_option("--clamp-direct", options->clamp_direct,
                  "Most radiance that a path of direct light adds to a sample, W/(m2 sr); biased")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--clamp-indirect", options->clamp_indirect,
                  "The same of indirect light: fewer bright dots for a darker picture; biased")
      ->check(CLI::PositiveNumber);
  command.add_option("--seed", options->seed, "Seed of all random numbers");
  CLI::Option* solution = command.add_option("--solution", options->solution_file,
                                             "Radiosity solution of twopass solve to use instead of solving");
  for (CLI::Option* option : options->radiosity.add_to(command)) solution->excludes(option);
  add_display_options(command, options->display);
  add_working_space_option(command, options->display.working_space);
  command
      .add_option("--exr-type", options->exr_type,
                  "Pixels of .exr files (default: as the scene says, else half)")
      ->check(CLI::IsMember({"half", "float"}));
  options->layers.add_to(command);
  command.add_flag("!--no-certificate", options->certificate,
                   "Do not measure the bias of twopass, which costs about 5 % of the rays");
  command.add_option("--stats", options->stats_file, "Write statistics as JSON");
  options->parts.add_to(command);
  command.callback(
      [options, &global, &action] { action = [options, &global] { return render(*options, global); }; });
}

}  // namespace twopass
