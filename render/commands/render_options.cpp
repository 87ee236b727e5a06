#include "render/commands/render_options.h"

#include <cstdio>

#include "render/core/error.h"

namespace twopass {

namespace {

constexpr double default_noise = 0.03;

void parse_size(const std::string& text, RenderSettings& settings) {
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

}  // namespace

RenderSettings settle(const RenderOptions& options, const FileSettings& file, const Console& console) {
  RenderSettings settings;
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

void RenderOptions::add_to(CLI::App& command) {
  scene.add_to(command);
  scene.add_sky_to(command);
  scene.add_view_to(command);
  command
      .add_option("-o,--output", outputs,
                  "Picture to write (repeatable): .exr scene-linear; .png, .jpg, .tif display-referred")
      ->required()
      ->allow_extra_args(false);
  command.add_option("--integrator", integrator, "twopass, unbiased, path, radiosity or direct");
  command.add_option("--sampler", sampler,
                     "sobol (default, whatever the scene says), stratified or independent");
  command.add_option("--spp", goal.samples_per_pixel, "Stop at this many samples a pixel")
      ->check(CLI::Range(1, most_samples_per_pixel));
  command.add_option("--time", goal.seconds, "Stop after this many seconds, pass one included")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--noise", goal.relative_error,
                  "Stop at this estimated relative error, sampling more where there is more noise")
      ->check(CLI::PositiveNumber);
  command.add_option("--size", size, "Picture size, WIDTHxHEIGHT");
  command
      .add_option(
          "--crop", crop,
          "The part of the picture to render, LEFT,TOP,WIDTH,HEIGHT in pixels; .exr files remember its place")
      ->delimiter(',')
      ->expected(4);
  command.add_option("--max-depth", max_depth, "Most edges of a path; -1 unlimited, 2 direct light")
      ->check(CLI::Range(-1, 1 << 30));
  command
      .add_option("--clamp-direct", clamp_direct,
                  "Most radiance that a path of direct light adds to a sample, W/(m2 sr); biased")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--clamp-indirect", clamp_indirect,
                  "The same of indirect light: fewer bright dots for a darker picture; biased")
      ->check(CLI::PositiveNumber);
  command.add_option("--seed", seed, "Seed of all random numbers");
  CLI::Option* solution = command.add_option("--solution", solution_file,
                                             "Radiosity solution of twopass solve to use instead of solving");
  for (CLI::Option* option : radiosity.add_to(command)) solution->excludes(option);
  add_display_options(command, display);
  add_working_space_option(command, display.working_space);
  command.add_option("--exr-type", exr_type, "Pixels of .exr files (default: as the scene says, else half)")
      ->check(CLI::IsMember({"half", "float"}));
  layers.add_to(command);
  command.add_flag("!--no-certificate", certificate,
                   "Do not measure the bias of twopass, which costs about 5 % of the rays");
  command.add_option("--stats", stats_file, "Write statistics as JSON");
  parts.add_to(command);
}

}  // namespace twopass
