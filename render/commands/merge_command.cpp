// twopass merge: partial pictures of one render into one.
#include <algorithm>
#include <cstdio>

#include "render/commands/command.h"
#include "render/commands/display_options.h"
#include "render/commands/long_render.h"
#include "render/commands/picture_outputs.h"
#include "render/core/error.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/image/atomic_file.h"

namespace twopass {

namespace {

struct MergeOptions {
  std::vector<std::string> parts, outputs;
  std::string checkpoint, exr_type;
  DisplayOptions display;
  bool denoise = false;
};

// Without its film: there may be more parts than memory for them, or than files that may be open.
struct Part {
  std::string path;
  PartialRender render;
  ExrOptions options;
};

// In the order of their samples, which makes the sums the same in whatever order they are given.
std::vector<Part> read_parts(const std::vector<std::string>& paths) {
  std::vector<Part> parts;
  for (const std::string& path : paths) {
    const PartialFile file(path);
    parts.push_back({path, file.part(), file.options()});
  }
  const auto begin = [](const Part& part) {
    return part.render.ranges.empty() ? 0 : part.render.ranges.front().begin;
  };
  std::stable_sort(parts.begin(), parts.end(),
                   [&](const Part& a, const Part& b) { return begin(a) < begin(b); });
  return parts;
}

// What all of them are together, as far as that is known without their films.
PartialRender joined(const std::vector<Part>& parts) {
  PartialRender all = parts.front().render;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const PartialRender& part = parts[i].render;
    check_same_render(part.identity, parts[i].path, all.identity, parts.front().path);
    all.ranges = joined_ranges(all.ranges, part.ranges, parts[i].path);
    all.all_samples = std::max(all.all_samples, part.all_samples);
    RayCounts& counts = all.state.costs.counts;
    counts.rays += part.state.costs.counts.rays;
    counts.shadow_rays += part.state.costs.counts.shadow_rays;
    counts.escaped_rays += part.state.costs.counts.escaped_rays;
    all.state.costs.non_finite_samples += part.state.costs.non_finite_samples;
  }
  return all;
}

// The samples of each pixel if they are all in one range; else 0.
std::uint32_t even_samples(const Film& film, const std::vector<SampleRange>& ranges) {
  if (ranges.size() != 1) return 0;
  const std::uint32_t samples = ranges.front().end - ranges.front().begin;
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x)
      if (film.pixel(x, y).samples != samples) return 0;
  return samples;
}

void note_what_is_missing(const PartialRender& all, bool even, const Console& console) {
  std::vector<SampleRange> missing;
  std::uint32_t next = 0;
  for (const SampleRange& range : all.ranges) {
    if (range.begin > next) missing.push_back({next, range.begin});
    next = range.end;
  }
  if (next < all.all_samples) missing.push_back({next, all.all_samples});
  if (all.all_samples > 0 && !missing.empty())
    console.note("samples " + ranges_text(missing) + " of " + std::to_string(all.all_samples) +
                 " are in none of the parts: the picture is noisier than planned");
  else if (all.all_samples > 0 && !even)
    console.note("some parts were interrupted: their pixels have fewer samples than planned");
}

// The metadata of a finished picture: that of the first part, with what is different now.
ExrOptions options_of_picture(const Part& first, const Film& film, const std::string& exr_type) {
  ExrOptions options = first.options;
  if (!exr_type.empty()) options.pixel_type = exr_type == "half" ? PixelType::half : PixelType::float_;
  const double pixels = static_cast<double>(film.width()) * film.height();
  for (auto& [name, value] : options.metadata) {
    if (name == "twopass/spp") value = static_cast<float>(static_cast<double>(film.samples()) / pixels);
    if (name == "twopass/stopReason") value = std::string("merged");
  }
  return options;
}

// The name of the space that the parts are in, which must be the same in this configuration.
std::string working_space_of(const Part& part, const std::string& config) {
  for (const auto& [name, value] : part.options.metadata) {
    if (name != working_space_metadata) continue;
    const std::string space = std::get<std::string>(value);
    const std::string found = find_working_space(space, config).interop_id;
    const std::string& made = part.options.color_space;
    if (made != (found.empty() ? unknown_space : found))
      throw Error(part.path,
                  "it is in " + space + " (" + made + "), which is " + (found.empty() ? "another" : found) +
                      " in this OpenColorIO configuration",
                  "give the configuration that it was rendered with: --ocio");
    return space;
  }
  return {};
}

int merge(const MergeOptions& options, const GlobalOptions& global) {
  const Console console = global.console();
  PictureOutputs pictures(options.outputs, options.display);
  if (!options.checkpoint.empty()) check_writable(options.checkpoint);
  const ThreadLimit limit(global.threads);
  if (options.denoise) pictures.set_denoiser(global.threads);

  const std::vector<Part> parts = read_parts(options.parts);
  pictures.set_working_space(working_space_of(parts.front(), options.display.config));
  PartialRender all = joined(parts);
  const PartialFile first(parts.front().path);
  Film film(first.width(), first.height(), first.layout());
  first.merge_into(film, &all.state.plan);
  for (std::size_t i = 1; i < parts.size(); ++i) {
    throw_if_interrupted();
    PartialFile(parts[i].path).merge_into(film);
  }
  const std::uint32_t even = even_samples(film, all.ranges);
  note_what_is_missing(all, even > 0, console);
  if (parts.size() > 1) {
    all.can_resume = even > 0;
    all.state.plan = {.before = static_cast<double>(even), .after = static_cast<double>(even)};
  }

  const ExrOptions exr = options_of_picture(parts.front(), film, options.exr_type);
  if (!options.checkpoint.empty()) {
    save_partial(options.checkpoint, film, all, exr);
    if (!global.quiet) std::printf("wrote %s\n", options.checkpoint.c_str());
  }
  pictures.write(film.resolve_all(), exr);
  if (global.quiet) return 0;
  for (const std::string& output : options.outputs) std::printf("wrote %s\n", output.c_str());
  std::printf("%zu parts, %dx%d, %.4g samples a pixel", parts.size(), film.width(), film.height(),
              static_cast<double>(film.samples()) / (static_cast<double>(film.width()) * film.height()));
  if (const double error = film.relative_error(); std::isfinite(error))
    std::printf(", estimated noise %.3g", error);
  std::printf("\n");
  return 0;
}

}  // namespace

void add_merge_command(CLI::App& program, const GlobalOptions& global, Action& action) {
  auto options = std::make_shared<MergeOptions>();
  CLI::App& command = *program.add_subcommand("merge", "Partial pictures of one render into one");
  command.add_option("part", options->parts, "Files of render --slice or --checkpoint, in any order")
      ->required();
  command
      .add_option("-o,--output", options->outputs,
                  "Picture to write (repeatable): .exr scene-linear; .png, .jpg, .tif display-referred")
      ->allow_extra_args(false);
  command.add_option("--checkpoint", options->checkpoint,
                     "Write the merged part to this .exr, to be merged or resumed");
  add_display_options(command, options->display);
  add_denoise_option(command, options->denoise);
  command
      .add_option("--exr-type", options->exr_type,
                  "Pixels of .exr files (default: as the render was to have them)")
      ->check(CLI::IsMember({"half", "float"}));
  command.callback([options, &global, &action] {
    if (options->outputs.empty() && options->checkpoint.empty()) throw CLI::RequiredError("--output");
    action = [options, &global] { return merge(*options, global); };
  });
}

}  // namespace twopass
