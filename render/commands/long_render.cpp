#include "render/commands/long_render.h"

#include <cstdio>

#include <unistd.h>

#include "render/core/error.h"
#include "render/core/interrupt.h"
#include "render/image/atomic_file.h"
#include "render/preview/connection.h"

namespace twopass {
namespace {

namespace fs = std::filesystem;

fs::path previous_of(const fs::path& path) {
  fs::path previous = path;
  return previous.replace_extension(".previous" + path.extension().string());
}

// The file, or the one before it where a file system without second names was interrupted between the two.
fs::path file_to_resume(const fs::path& path, const Console& console) {
  std::error_code ignored;
  if (fs::exists(path, ignored) || !fs::exists(previous_of(path), ignored)) return path;
  console.note(path.string() + ": is missing, " + previous_of(path).string() + " is taken");
  return previous_of(path);
}

PartialFile open_to_resume(const fs::path& path) {
  try {
    return PartialFile(path);
  } catch (const Error& error) {
    std::error_code ignored;
    if (!fs::exists(previous_of(path), ignored)) throw;
    throw Error("--resume", std::string("not possible (") + error.what() + ")",
                "try the file before it: --resume " + previous_of(path).string());
  }
}

struct Slice {
  std::uint32_t number, count;
};

Slice parse_slice(const std::string& text) {
  unsigned number = 0, count = 0;
  int consumed = 0;
  if (std::sscanf(text.c_str(), "%u/%u%n", &number, &count, &consumed) != 2 ||
      consumed != static_cast<int>(text.size()) || count < 1 || count > most_samples_per_pixel ||
      number > count)
    throw Error("--slice " + text, "not a share of a render",
                "write K/N, for example 1/4, with K from 1 to N (or from 0 to N-1: 0 is the same as N)");
  return {(number + count - 1) % count, count};
}

std::uint32_t most_samples(const Film& film) {
  std::uint64_t most = 0;
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x) most = std::max(most, film.pixel(x, y).samples);
  return static_cast<std::uint32_t>(most);
}

}  // namespace

void LongRenderOptions::add_to(CLI::App& command) {
  command.add_option("--slice", slice,
                     "Render share K of N of the samples, K/N; .exr outputs are parts for twopass merge");
  command.add_option(
      "--checkpoint", checkpoint,
      "Write what there is to this .exr now and then and at the end, for --resume and twopass merge");
  command.add_option("--checkpoint-interval", interval, "Seconds between checkpoints")
      ->check(CLI::PositiveNumber);
  command.add_option("--resume", resume, "Go on where this file of --checkpoint or --slice stops");
  command.add_option("--preview", preview,
                     "Show the picture meanwhile in tev or HDRView, HOST:PORT (tev: 127.0.0.1:14158)");
}

void save_checkpoint(const fs::path& path, const Film& film, const PartialRender& part,
                     const ExrOptions& options) {
  save_partial(path, film, part, options, previous_of(path));
}

LongRender::LongRender(const LongRenderOptions& options, const Console& console)
    : options_(options), console_(console) {
  if (!options.checkpoint.empty()) {
    if (fs::path(options.checkpoint).extension() != ".exr")
      throw Error("--checkpoint " + options.checkpoint, "checkpoints are OpenEXR files",
                  "give it a name that ends in .exr");
    check_writable(options.checkpoint);
  }
  if (!options.preview.empty()) (void)parse_address(options.preview, "--preview");
  if (options.resume.empty()) return;
  resumed_ = open_to_resume(file_to_resume(options.resume, console));
  if (!resumed_->part().can_resume)
    throw Error(options.resume, "its pixels have different samples, as slices are missing or were interrupted",
                "render the missing slices and merge them with it");
}

void LongRender::divide(SamplingGoal& goal) {
  part_.footprint_samples = goal.samples_per_pixel;
  part_.all_samples = static_cast<std::uint32_t>(goal.samples_per_pixel);
  if (is_slice()) {
    const Slice slice = parse_slice(options_.slice);
    if (goal.samples_per_pixel == 0 || goal.relative_error > 0.0)
      throw Error("--slice " + options_.slice, "how many samples are to be shared is not known in advance",
                  "give the number of the whole picture with --spp, and no --noise");
    const auto part = [&](std::uint32_t k) {
      return static_cast<std::uint32_t>(std::uint64_t{part_.all_samples} * k / slice.count);
    };
    first_sample_ = part(slice.number);
    goal.samples_per_pixel = static_cast<int>(part(slice.number + 1) - first_sample_);
    if (goal.samples_per_pixel == 0)
      throw Error("--slice " + options_.slice,
                  std::to_string(part_.all_samples) + " samples a pixel are fewer than " +
                      std::to_string(slice.count) + " slices",
                  "use at most as many slices as there are samples");
    console_.note("slice " + options_.slice + ": samples " +
                  ranges_text({{first_sample_, part(slice.number + 1)}}) + " of " +
                  std::to_string(part_.all_samples));
  }
  if (!resumed_) return;
  part_.footprint_samples = resumed_->part().footprint_samples;
  const std::vector<SampleRange>& ranges = resumed_->part().ranges;
  if (!ranges.empty() && ranges.front().begin != first_sample_)
    throw Error(options_.resume,
                "it holds samples " + ranges_text(ranges) + " of each pixel, this render begins with " +
                    std::to_string(first_sample_),
                "resume with the --slice and --spp that it was made with");
}

void LongRender::begin(RenderIdentity identity, Film& film) {
  part_.identity = std::move(identity);
  if (!resumed_) return;
  check_same_render(resumed_->part().identity, options_.resume, part_.identity, "this render");
  resumed_state_.costs = resumed_->part().state.costs;
  resumed_->merge_into(film, &resumed_state_.plan);
  resumed_.reset();  // the file may be replaced now
  console_.note("resumed " + options_.resume + ": " +
                std::to_string(film.samples() / (static_cast<std::uint64_t>(film.width()) *
                                                 static_cast<std::uint64_t>(film.height()))) +
                " samples a pixel");
}

void LongRender::prepare(RenderJob& job, const Film& film, const std::string& name,
                         const ColorMatrix& to_rec709, const std::function<void(const RenderState&)>& write,
                         const std::function<ExrOptions(const RenderState&)>& options) {
  job.first_sample = first_sample_;
  job.all_samples = part_.all_samples;
  if (!options_.resume.empty()) job.resumed = &resumed_state_;
  if (!options_.preview.empty()) {
    preview_.emplace(
        options_.preview, name + " (" + std::to_string(::getpid()) + ")", film.width(), film.height(),
        [this](const std::string& text) { console_.note(text); }, to_rec709);
    if (film.samples() > 0) preview_->update(film, {0, 0}, {film.width(), film.height()});
    job.tile_done = [this, &film](const V2i& corner, const V2i& size) { preview_->update(film, corner, size); };
  }
  stopwatch_ = Stopwatch();
  next_checkpoint_ = options_.interval;
  const auto is_due = [this] {
    return !options_.checkpoint.empty() && stopwatch_.seconds() >= next_checkpoint_;
  };
  job.wants_pause = [is_due] { return write_requested() || is_due(); };
  job.at_pause = [this, &film, &write, &options, is_due](const RenderState& state) {
    const bool asked = write_requested().exchange(false);
    // What cannot be written now is no reason to stop: there may be room again at the next time.
    const auto trying = [&](const auto& action) {
      try {
        action();
        return true;
      } catch (const Error& error) {
        console_.note(std::string(error.what()) + " (rendering goes on)");
        return false;
      }
    };
    if (asked && film.samples() == 0) {
      console_.note("SIGUSR1: there is nothing to write yet");
    } else if (asked || is_due()) {
      bool done = trying([&] { finish(film, state, options(state)); });
      if (asked) done = trying([&] { write(state); }) && done;
      if (asked && done) console_.note("SIGUSR1: wrote what there is, rendering goes on");
      next_checkpoint_ = stopwatch_.seconds() + options_.interval;
    }
  };
}

PartialRender LongRender::part_of(const Film& film, const RenderState& state) const {
  PartialRender part = part_;
  part.state = state;
  part.ranges = {{first_sample_, first_sample_ + most_samples(film)}};
  return part;
}

void LongRender::save(const fs::path& path, const Film& film, const RenderState& state,
                      const ExrOptions& options) const {
  save_partial(path, film, part_of(film, state), options);
}

void LongRender::finish(const Film& film, const RenderState& state, const ExrOptions& options) const {
  if (!options_.checkpoint.empty()) save_checkpoint(options_.checkpoint, film, part_of(film, state), options);
}

}  // namespace twopass
