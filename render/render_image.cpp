#include "render/render_image.h"

#include <atomic>
#include <limits>
#include <vector>

#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/stopwatch.h"

namespace twopass {

namespace {

constexpr int tile_size = 16;

// Samples that were not finite: how many, and the first of them: its pixel's number in the film << 32 | its
// own.
struct NonFinite {
  static constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t count = 0, first = none;

  void add(std::size_t pixel, std::uint32_t sample) {
    ++count;
    first = std::min(first, std::uint64_t{pixel} << 32 | sample);
  }
};

struct Tally {
  std::atomic<std::uint64_t> rays{0}, shadow_rays{0}, escaped_rays{0}, non_finite{0},
      first_non_finite{NonFinite::none};

  void add(const NonFinite& more) {
    non_finite += more.count;
    std::uint64_t first = first_non_finite;
    while (more.first < first && !first_non_finite.compare_exchange_weak(first, more.first)) {
    }
  }
};

// The samples of a few pixels, traced together.
class PixelGroup {
 public:
  PixelGroup(const RenderJob& job, Film& film) : job_(job), film_(film) {
    if (job.layers) layers_.emplace(*job.layers);
  }

  /// Draws the camera rays of a pixel's samples.
  void add(int x, int y, const SampleRange& range) {
    const V2i pixel = V2i(x, y) + job_.corner;
    const std::uint32_t stream = stream_of(pixel);
    const auto strata =
        job_.all_samples > 0 ? job_.all_samples : static_cast<std::uint32_t>(job_.goal.samples_per_pixel);
    pixels_.push_back({x, y, range});
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      Sampler sampler(job_.seed, stream, job_.first_sample + i, job_.sampler, strata);
      // The filter is sampled instead of splatted, so that a sample lands in one pixel (Ernst et al. 2006).
      const FilterSample at = sample_filter(job_.filter, sampler.next_2d());
      const V2f lens = job_.camera.has_lens() ? sampler.next_2d() : V2f(0.0f, 0.0f);
      const CameraRay seen = job_.camera.ray(
          {static_cast<float>(pixel.x) + 0.5f + at.offset.x, static_cast<float>(pixel.y) + 0.5f + at.offset.y},
          lens);
      samples_.push_back({seen.ray, sampler, {}, seen.reach});
      if (job_.cone.is_open()) samples_.back().cone = job_.cone;
      weights_.push_back(at.weight);
      distances2_.push_back(at.offset.dot(at.offset));
    }
  }
  [[nodiscard]] std::size_t size() const { return samples_.size(); }

  /// Traces all of them into the film and starts anew.
  void finish(RayCounts& counts, NonFinite& non_finite) {
    if (layers_) layers_->prepare(samples_);
    job_.integrator.trace(samples_, counts);
    std::size_t next = 0;
    for (const Pixel& pixel : pixels_) {
      PixelBatch batch;
      for (std::uint32_t i = pixel.range.begin; i < pixel.range.end; ++i, ++next) {
        if (!batch.add(samples_[next].seen.radiance, samples_[next].seen.alpha, weights_[next]))
          non_finite.add(film_.index(pixel.x, pixel.y), job_.first_sample + i);
        if (layers_)
          layers_->add(next, samples_[next], weights_[next], distances2_[next], film_,
                       film_.index(pixel.x, pixel.y));
      }
      film_.add_pixel(pixel.x, pixel.y, batch);
    }
    pixels_.clear();
    samples_.clear();
    weights_.clear();
    distances2_.clear();
  }

 private:
  // Which random numbers a pixel has: those beyond the picture's border have their own, too.
  [[nodiscard]] std::uint32_t stream_of(const V2i& pixel) const {
    const auto x = static_cast<std::uint32_t>(pixel.x), y = static_cast<std::uint32_t>(pixel.y);
    const bool is_inside =
        pixel.x >= 0 && pixel.y >= 0 && pixel.x < job_.camera.width() && pixel.y < job_.camera.height();
    return is_inside ? y * static_cast<std::uint32_t>(job_.camera.width()) + x
                     : 0x80000000u ^ (y * 0x10001u + x);
  }
  struct Pixel {
    int x, y;
    SampleRange range;
  };
  const RenderJob& job_;
  Film& film_;
  std::vector<Pixel> pixels_;
  std::vector<PathSample> samples_;
  std::vector<float> weights_, distances2_;
  std::optional<Layers::Samples> layers_;
};

// One pass over a tile, as many pixels at once as fill a bundle.
void render_tile(const RenderJob& job, Film& film, int tile, const SamplePlan& plan, Tally& tally) {
  const int tiles_x = (film.width() + tile_size - 1) / tile_size;
  const int x0 = tile % tiles_x * tile_size, y0 = tile / tiles_x * tile_size;
  RayCounts counts;
  NonFinite non_finite;
  PixelGroup group(job, film);
  for (int y = y0; y < std::min(y0 + tile_size, film.height()); ++y)
    for (int x = x0; x < std::min(x0 + tile_size, film.width()); ++x) {
      const SampleRange range = plan.range(x, y);
      if (range.begin >= range.end) continue;
      group.add(x, y, range);
      if (group.size() >= bundle_size) group.finish(counts, non_finite);
    }
  group.finish(counts, non_finite);
  tally.rays += counts.rays;
  tally.shadow_rays += counts.shadow_rays;
  tally.escaped_rays += counts.escaped_rays;
  tally.add(non_finite);
  if (job.tile_done)
    job.tile_done({x0, y0}, {std::min(tile_size, film.width() - x0), std::min(tile_size, film.height() - y0)});
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

// What progress says of the error, looked at only when there are twice the samples: that takes as long as some.
class KnownError {
 public:
  double update(const SamplePlan& plan, const Film& film) {
    if (std::isfinite(plan.error())) return error_ = plan.error();
    if (plan.mean_before() >= next_) {
      error_ = film.relative_error();
      next_ = 2.0 * plan.mean_before();
    }
    return error_;
  }

 private:
  double error_ = std::numeric_limits<double>::infinity(), next_ = 2.0;
};

// Why the tiles of a pass were left.
enum class Leave { finished, interrupted, out_of_time, pause };

class ImageRender {
 public:
  ImageRender(const RenderJob& job, Film& film)
      : job_(job),
        film_(film),
        tiles_(((film.width() + tile_size - 1) / tile_size) * ((film.height() + tile_size - 1) / tile_size)),
        plan_(job.resumed != nullptr ? SamplePlan(job.goal, film, job.resumed->plan)
                                     : SamplePlan(job.goal, film)) {
    if (job.resumed == nullptr) return;
    const RenderCosts& costs = job.resumed->costs;
    tally_.rays = costs.counts.rays;
    tally_.shadow_rays = costs.counts.shadow_rays;
    tally_.escaped_rays = costs.counts.escaped_rays;
    tally_.non_finite = costs.non_finite_samples;
    rays_before_ = costs.counts.rays + costs.counts.shadow_rays;
  }

  RenderOutcome run() {
    const std::string reason = passes();
    const RenderCosts all = costs();
    return {.counts = all.counts,
            .non_finite_samples = all.non_finite_samples,
            .first_non_finite = first_non_finite(),
            .stop_reason = reason,
            .pixels_stopped_early = share_stopped_early(film_),
            .plan = plan_.state(in_pass_)};
  }

 private:
  // Renders until a goal is met; the result is the reason.
  std::string passes() {
    in_pass_ = job_.resumed != nullptr && job_.resumed->plan.in_pass;
    for (;;) {
      if (!in_pass_ && !plan_.next()) return plan_.stop_reason();
      in_pass_ = true;
      ++pass_;
      if (job_.report_progress) error_ = known_error_.update(plan_, film_);
      std::vector<std::uint8_t> done(static_cast<std::size_t>(tiles_), 0);
      Leave leave = Leave::finished;
      while ((leave = render_tiles(done)) == Leave::pause) job_.at_pause({plan_.state(true), costs()});
      if (leave == Leave::interrupted) return "interrupted";
      if (leave == Leave::out_of_time) return "time";
      in_pass_ = false;
      if (job_.goal.seconds > 0.0 && stopwatch_.seconds() >= job_.goal.seconds) return "time";
    }
  }

  // Those tiles of the pass that are not done, until there is a reason to leave.
  Leave render_tiles(std::vector<std::uint8_t>& done) {
    std::atomic<Leave> leave{Leave::finished};
    std::atomic<int> tiles_done{static_cast<int>(std::count(done.begin(), done.end(), 1))};
    parallel_for(done.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t tile = begin; tile < end; ++tile) {
        if (done[tile] != 0) continue;
        if (leave != Leave::finished) return;
        if (const Leave reason = reason_to_leave(); reason != Leave::finished) {
          leave = reason;
          return;
        }
        render_tile(job_, film_, static_cast<int>(tile), plan_, tally_);
        done[tile] = 1;
        report(static_cast<double>(++tiles_done) / tiles_);
      }
    });
    return leave;
  }

  [[nodiscard]] Leave reason_to_leave() const {
    if (interrupt_requested()) return Leave::interrupted;
    // The first pass is finished in any case: a picture with holes helps nobody.
    if (plan_.mean_before() > 0.0 && job_.goal.seconds > 0.0 && stopwatch_.seconds() >= job_.goal.seconds)
      return Leave::out_of_time;
    return job_.wants_pause && job_.wants_pause() ? Leave::pause : Leave::finished;
  }

  void report(double in_pass) const {
    if (!job_.report_progress) return;
    const double seconds = stopwatch_.seconds();
    const double mean = plan_.mean_before() + in_pass * (plan_.mean_after() - plan_.mean_before());
    job_.report_progress(
        {.fraction = fraction_done(job_.goal, plan_, in_pass, seconds),
         .pass = pass_,
         .samples_per_pixel = mean,
         .error = error_,
         .rays_per_second = static_cast<double>(tally_.rays + tally_.shadow_rays - rays_before_) / seconds});
  }

  [[nodiscard]] RenderCosts costs() const {
    return {{tally_.rays, tally_.shadow_rays, tally_.escaped_rays}, tally_.non_finite};
  }

  [[nodiscard]] std::optional<SamplePlace> first_non_finite() const {
    const std::uint64_t first = tally_.first_non_finite;
    if (first == NonFinite::none) return std::nullopt;
    const auto pixel = static_cast<std::uint32_t>(first >> 32),
               width = static_cast<std::uint32_t>(film_.width());
    return SamplePlace{job_.corner + V2i(static_cast<int>(pixel % width), static_cast<int>(pixel / width)),
                       static_cast<std::uint32_t>(first)};
  }

  const RenderJob& job_;
  Film& film_;
  int tiles_;
  const Stopwatch stopwatch_;
  Tally tally_;
  std::uint64_t rays_before_ = 0;
  SamplePlan plan_;
  KnownError known_error_;
  double error_ = std::numeric_limits<double>::infinity();
  int pass_ = 0;
  bool in_pass_ = false;
};

}  // namespace

RenderOutcome render_image(const RenderJob& job, Film& film) { return ImageRender(job, film).run(); }

}  // namespace twopass
