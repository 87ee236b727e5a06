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
  std::atomic<std::uint64_t> rays{0}, shadow_rays{0}, non_finite{0};
};

// One pass: samples [first, first + count) of every pixel of a tile, as many pixels at once as fill a bundle.
void render_tile(const RenderJob& job, Film& film, int tile, int first, int count, Tally& tally) {
  const int tiles_x = (film.width() + tile_size - 1) / tile_size;
  const int x0 = tile % tiles_x * tile_size, y0 = tile / tiles_x * tile_size;
  const int width = std::min(tile_size, film.width() - x0), height = std::min(tile_size, film.height() - y0);
  const int pixels = width * height, pixels_at_once = std::max(1, static_cast<int>(bundle_size) / count);
  std::vector<PathSample> samples;
  std::vector<float> weights;
  RayCounts counts;
  std::uint64_t non_finite = 0;
  for (int begin = 0; begin < pixels; begin += pixels_at_once) {
    const int end = std::min(begin + pixels_at_once, pixels);
    samples.clear(), weights.clear();
    for (int pixel = begin; pixel < end; ++pixel) {
      const int x = x0 + pixel % width, y = y0 + pixel / width;
      const auto stream = static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(film.width()) +
                          static_cast<std::uint32_t>(x);
      for (int i = first; i < first + count; ++i) {
        Sampler sampler(job.seed, stream, static_cast<std::uint32_t>(i));
        // The filter is sampled instead of splatted, so that a sample lands in one pixel (Ernst et al. 2006).
        const FilterSample at = sample_filter(job.filter, sampler.next_2d());
        const Ray ray = job.camera.ray(
            {static_cast<float>(x) + 0.5f + at.offset.x, static_cast<float>(y) + 0.5f + at.offset.y});
        samples.push_back({ray, sampler});
        weights.push_back(at.weight);
      }
    }
    job.integrator.trace(samples, counts);
    for (int pixel = begin; pixel < end; ++pixel) {
      PixelBatch batch;
      for (int i = (pixel - begin) * count; i < (pixel - begin + 1) * count; ++i) {
        const auto s = static_cast<std::size_t>(i);
        if (!batch.add(samples[s].seen.radiance, samples[s].seen.alpha, weights[s])) ++non_finite;
      }
      film.add_pixel(x0 + pixel % width, y0 + pixel / width, batch);
    }
  }
  tally.rays += counts.rays;
  tally.shadow_rays += counts.shadow_rays;
  tally.non_finite += non_finite;
}

// Passes are the batches of the error estimate: enough of them to be one, few enough to cost nothing.
int samples_of_pass(const SamplingGoal& goal, int limit, int done) {
  const int wanted =
      goal.samples_per_pixel > 0 && goal.relative_error <= 0.0 ? std::clamp(limit / 8, 1, 16) : 8;
  return std::min(wanted, limit - done);
}

}  // namespace

RenderOutcome render_image(const RenderJob& job, Film& film) {
  const Stopwatch stopwatch;
  const int limit = job.goal.samples_per_pixel > 0 ? job.goal.samples_per_pixel : most_samples_per_pixel;
  const int tiles =
      ((film.width() + tile_size - 1) / tile_size) * ((film.height() + tile_size - 1) / tile_size);
  Tally tally;
  RenderOutcome outcome{.counts = {}, .non_finite_samples = 0, .stop_reason = "samples"};
  double noise_fraction = 0.0;

  for (int done = 0; done < limit;) {
    const int count = samples_of_pass(job.goal, limit, done);
    std::atomic<int> tiles_done{0};
    std::atomic<bool> out_of_time{false};
    parallel_for(static_cast<std::size_t>(tiles), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t tile = begin; tile < end; ++tile) {
        if (interrupt_requested()) return;
        const double seconds = stopwatch.seconds();
        // The first pass is finished in any case: a picture with holes helps nobody.
        if (done > 0 && job.goal.seconds > 0.0 && seconds >= job.goal.seconds) {
          out_of_time = true;
          return;
        }
        render_tile(job, film, static_cast<int>(tile), done, count, tally);
        const double in_pass = static_cast<double>(++tiles_done) / tiles;
        double fraction = noise_fraction;
        if (job.goal.samples_per_pixel > 0) fraction = std::max(fraction, (done + in_pass * count) / limit);
        if (job.goal.seconds > 0.0) fraction = std::max(fraction, seconds / job.goal.seconds);
        if (job.report_progress) job.report_progress(fraction);
      }
    });
    done += count;
    if (interrupt_requested()) {
      outcome.stop_reason = "interrupted";
      break;
    }
    if (out_of_time || (job.goal.seconds > 0.0 && stopwatch.seconds() >= job.goal.seconds)) {
      outcome.stop_reason = "time";
      break;
    }
    if (job.goal.relative_error > 0.0) {
      const double error = film.relative_error();
      if (error <= job.goal.relative_error) {
        outcome.stop_reason = "noise";
        break;
      }
      // The error falls with the root of the samples.
      noise_fraction = (job.goal.relative_error / error) * (job.goal.relative_error / error);
    }
  }
  outcome.counts = {tally.rays, tally.shadow_rays};
  outcome.non_finite_samples = tally.non_finite;
  return outcome;
}

}  // namespace twopass
