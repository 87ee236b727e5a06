// What long renders ask for: a share of the samples, checkpoints, going on where one stopped.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "render/console.h"
#include "render/partial_render.h"
#include "render/preview/preview.h"
#include "render/stopwatch.h"

namespace twopass {

struct LongRenderOptions {
  std::string slice, checkpoint, resume, preview;
  double interval = 60.0;  ///< seconds from one checkpoint to the next

  void add_to(CLI::App& command);
};

/// Writes the partial picture `path` and keeps what was there as NAME.previous.EXTENSION. Throws Error.
void save_checkpoint(const std::filesystem::path& path, const Film& film, const PartialRender& part,
                     const ExrOptions& options);

class LongRender {
 public:
  /// Looks at the options and at the file to resume. Throws Error for what cannot be.
  LongRender(const LongRenderOptions& options, const Console& console);

  /// Makes the goal of the whole picture that of this share of it. Throws Error when it has no number of
  /// samples.
  void divide(SamplingGoal& goal);
  [[nodiscard]] bool is_slice() const { return !options_.slice.empty(); }
  /// Samples of a pixel for which textures are filtered: those of the whole, and of the first part of a resumed
  /// render.
  [[nodiscard]] int footprint_samples() const { return part_.footprint_samples; }
  /// Samples of a pixel in all parts; 0: not known.
  [[nodiscard]] std::uint32_t all_samples() const { return part_.all_samples; }

  /// Puts what was sampled before into the empty film. Throws Error when that was another render.
  void begin(RenderIdentity identity, Film& film);
  /// Fills in where the job begins, when it pauses and who looks on. `write` writes the pictures as they are,
  /// and `options` are those of a picture, `name` what a viewer calls it; `to_rec709`: of the
  /// film's colours. REQUIRES: this, film and both functions outlive the job.
  void prepare(RenderJob& job, const Film& film, const std::string& name, const ColorMatrix& to_rec709,
               const std::function<void(const RenderState&)>& write,
               const std::function<ExrOptions(const RenderState&)>& options);
  /// Sends the viewer what it has not seen yet.
  void end_preview() { preview_.reset(); }
  /// What there is, as a partial picture.
  void save(const std::filesystem::path& path, const Film& film, const RenderState& state,
            const ExrOptions& options) const;
  /// The last checkpoint, if there are to be some. Throws Error.
  void finish(const Film& film, const RenderState& state, const ExrOptions& options) const;

 private:
  [[nodiscard]] PartialRender part_of(const Film& film, const RenderState& state) const;

  const LongRenderOptions& options_;
  const Console& console_;
  std::optional<PartialFile> resumed_;
  std::optional<Preview> preview_;
  PartialRender part_;
  RenderState resumed_state_;
  std::uint32_t first_sample_ = 0;
  Stopwatch stopwatch_;
  double next_checkpoint_ = 0.0;
};

}  // namespace twopass
