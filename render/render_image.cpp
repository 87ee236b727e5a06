#include "render/render_image.h"

#include <atomic>
#include <vector>

#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/stopwatch.h"

namespace twopass {

namespace {

constexpr int tile_size = 16;

struct Tally {
  std::atomic<std::uint64_t> rays{0}, shadow_rays{0}, escaped_rays{0}, non_finite{0};
};

// The samples of a few pixels, traced together.
class PixelGroup {
 public:
  PixelGroup(const RenderJob& job, Film& film) : job_(job), film_(film) {}

  /// Draws the camera rays of a pixel's samples.
  void add(int x, int y, const SampleRange& range) {
    const V2i pixel = V2i(x, y) + job_.corner;
    const auto stream = static_cast<std::uint32_t>(pixel.y) * static_cast<std::uint32_t>(job_.camera.width()) +
                        static_cast<std::uint32_t>(pixel.x);
    const auto strata = static_cast<std::uint32_t>(job_.goal.samples_per_pixel);
    pixels_.push_back({x, y, range.end - range.begin});
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      Sampler sampler(job_.seed, stream, i, job_.sampler, strata);
      // The filter is sampled instead of splatted, so that a sample lands in one pixel (Ernst et al. 2006).
      const FilterSample at = sample_filter(job_.filter, sampler.next_2d());
      const V2f lens = job_.camera.has_lens() ? sampler.next_2d() : V2f(0.0f, 0.0f);
      const CameraRay seen = job_.camera.ray(
          {static_cast<float>(pixel.x) + 0.5f + at.offset.x, static_cast<float>(pixel.y) + 0.5f + at.offset.y},
          lens);
      samples_.push_back({seen.ray, sampler, {}, seen.reach});
      if (job_.cone.is_open()) samples_.back().cone = job_.cone;
      weights_.push_back(at.weight);
    }
  }
  [[nodiscard]] std::size_t size() const { return samples_.size(); }

  /// Traces all of them into the film and starts anew. The number of samples that were not finite.
  std::uint64_t finish(RayCounts& counts) {
    job_.integrator.trace(samples_, counts);
    std::uint64_t non_finite = 0;
    std::size_t next = 0;
    for (const Pixel& pixel : pixels_) {
      PixelBatch batch;
      for (const std::size_t end = next + pixel.samples; next < end; ++next)
        if (!batch.add(samples_[next].seen.radiance, samples_[next].seen.alpha, weights_[next])) ++non_finite;
      film_.add_pixel(pixel.x, pixel.y, batch);
    }
    pixels_.clear();
    samples_.clear();
    weights_.clear();
    return non_finite;
  }

 private:
  struct Pixel {
    int x, y;
    std::uint32_t samples;
  };
  const RenderJob& job_;
  Film& film_;
  std::vector<Pixel> pixels_;
  std::vector<PathSample> samples_;
  std::vector<float> weights_;
};

// One pass over a tile, as many pixels at once as fill a bundle.
void render_tile(const RenderJob& job, Film& film, int tile, const SamplePlan& plan, Tally& tally) {
  const int tiles_x = (film.width() + tile_size - 1) / tile_size;
  const int x0 = tile % tiles_x * tile_size, y0 = tile / tiles_x * tile_size;
  RayCounts counts;
  std::uint64_t non_finite = 0;
  PixelGroup group(job, film);
  for (int y = y0; y < std::min(y0 + tile_size, film.height()); ++y)
    for (int x = x0; x < std::min(x0 + tile_size, film.width()); ++x) {
      const SampleRange range = plan.range(x, y);
      if (range.begin >= range.end) continue;
      group.add(x, y, range);
      if (group.size() >= bundle_size) non_finite += group.finish(counts);
    }
  non_finite += group.finish(counts);
  tally.rays += counts.rays;
  tally.shadow_rays += counts.shadow_rays;
  tally.escaped_rays += counts.escaped_rays;
  tally.non_finite += non_finite;
}

// Pixels that had fewer samples than the picture had on average.
double share_stopped_early(const Film& film) {
  const double pixels = static_cast<double>(film.width()) * film.height();
  const double mean = static_cast<double>(film.samples()) / pixels;
  double early = 0.0;
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x)
      if (static_cast<double>(film.pixel(x, y).samples) < mean) early += 1.0;
  return early / pixels;
}

// What is done of the goal that is nearest, `in_pass` of the present pass being done.
double fraction_done(const SamplingGoal& goal, const SamplePlan& plan, double in_pass, double seconds) {
  const double mean = plan.mean_before() + in_pass * (plan.mean_after() - plan.mean_before());
  double fraction = 0.0;
  if (goal.samples_per_pixel > 0) fraction = mean / goal.samples_per_pixel;
  if (goal.seconds > 0.0) fraction = std::max(fraction, seconds / goal.seconds);
  // The error falls with the root of the samples.
  if (goal.relative_error > 0.0 && plan.mean_before() > 0.0)
    fraction =
        std::max(fraction, std::pow(goal.relative_error / plan.error(), 2.0) * mean / plan.mean_before());
  return std::min(fraction, 1.0);
}

}  // namespace

RenderOutcome render_image(const RenderJob& job, Film& film) {
  const Stopwatch stopwatch;
  const int tiles =
      ((film.width() + tile_size - 1) / tile_size) * ((film.height() + tile_size - 1) / tile_size);
  Tally tally;
  RenderOutcome outcome{.counts = {}, .non_finite_samples = 0, .stop_reason = "samples"};
  SamplePlan plan(job.goal, film);

  for (;;) {
    if (!plan.next()) {
      outcome.stop_reason = plan.stop_reason();
      break;
    }
    std::atomic<int> tiles_done{0};
    std::atomic<bool> out_of_time{false};
    parallel_for(static_cast<std::size_t>(tiles), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t tile = begin; tile < end; ++tile) {
        if (interrupt_requested()) return;
        const double seconds = stopwatch.seconds();
        // The first pass is finished in any case: a picture with holes helps nobody.
        if (plan.mean_before() > 0.0 && job.goal.seconds > 0.0 && seconds >= job.goal.seconds) {
          out_of_time = true;
          return;
        }
        render_tile(job, film, static_cast<int>(tile), plan, tally);
        const double in_pass = static_cast<double>(++tiles_done) / tiles;
        if (job.report_progress) job.report_progress(fraction_done(job.goal, plan, in_pass, seconds));
      }
    });
    if (interrupt_requested()) {
      outcome.stop_reason = "interrupted";
      break;
    }
    if (out_of_time || (job.goal.seconds > 0.0 && stopwatch.seconds() >= job.goal.seconds)) {
      outcome.stop_reason = "time";
      break;
    }
  }
  outcome.counts = {tally.rays, tally.shadow_rays, tally.escaped_rays};
  outcome.non_finite_samples = tally.non_finite;
  outcome.pixels_stopped_early = share_stopped_early(film);
  return outcome;
}

}  // namespace twopass
