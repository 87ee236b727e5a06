#include "render/bench/series.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "integrators/clamp.h"
#include "render/core/interrupt.h"
#include "render/image/compare.h"
#include "render/pass_one.h"
#include "render/render_image.h"
#include "render/view_probe.h"

namespace twopass {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double relative_to(double r) { return r * r + relmse_epsilon; }

void accumulate(BenchPoint& sum, const BenchPoint& point) {
  sum.time += point.time;
  sum.pass_one += point.pass_one;
  sum.rays += point.rays;
  sum.relmse += point.relmse;
  sum.mse += point.mse;
  sum.smape += point.smape;
  sum.flip += point.flip;
  sum.energy_ratio += point.energy_ratio;
}

BenchPoint mean_of(BenchPoint sum, int samples, int runs) {
  const double n = runs;
  sum.samples_per_pixel = samples;
  for (Elapsed* elapsed : {&sum.time, &sum.pass_one}) {
    elapsed->seconds /= n;
    elapsed->cpu_seconds /= n;
  }
  sum.rays /= static_cast<std::uint64_t>(runs);
  for (double* value : {&sum.relmse, &sum.mse, &sum.smape, &sum.flip}) *value /= n;
  sum.energy_ratio /= n;
  return sum;
}

}  // namespace

void SeriesCollector::begin_run(std::uint32_t seed) {
  series_.runs.push_back({seed, 0, {}});
  next_level_ = 0;
}

const BenchPoint& SeriesCollector::add(BenchPoint point, const Image& picture) {
  if (next_level_ == levels_.size()) {
    levels_.emplace_back();
    levels_.back().samples_per_pixel = point.samples_per_pixel;
    levels_.back().sum.energy_ratio = C3d(0.0);  // a sum begins with nothing
    levels_.back().pixels.resize(picture.pixel_count(), C3d(0.0));
    levels_.back().squares.resize(picture.pixel_count(), C3d(0.0));
  }
  Level& level = levels_[next_level_++];
  const Comparison comparison = compare(picture, reference_.picture);
  point.relmse = comparison.relmse - reference_.relmse;
  point.mse = comparison.mse - reference_.mse;
  point.smape = comparison.smape;
  point.flip = comparison.flip;
  point.energy_ratio = comparison.energy_ratio;
  ++level.runs;
  accumulate(level.sum, point);
  const std::vector<C3f> colors = rgb_pixels(picture);
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const C3d color(colors[i]);
    level.pixels[i] += color;
    level.squares[i] += color * color;
  }
  if (series_.runs.size() == 1) series_.picture = picture;
  series_.runs.back().points.push_back(point);
  return series_.runs.back().points.back();
}

void SeriesCollector::end_run(std::size_t memory_bytes) { series_.runs.back().memory_bytes = memory_bytes; }

int SeriesCollector::last_samples() const { return levels_.empty() ? 0 : levels_.back().samples_per_pixel; }

BenchSeries SeriesCollector::finish() const {
  BenchSeries series = series_;
  const Level* last = nullptr;
  for (const Level& level : levels_) {
    if (level.runs < static_cast<int>(series_.runs.size())) break;  // a run was cut short
    last = &level;
    SeriesPoint point;
    static_cast<BenchPoint&>(point) = mean_of(level.sum, level.samples_per_pixel, level.runs);
    point.runs = level.runs;
    const double n = level.runs;
    double error = 0.0, variance = 0.0;
    for (std::size_t i = 0; i < level.pixels.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const double r = reference_.picture.pixels[3 * i + static_cast<std::size_t>(c)];
        const double mean = level.pixels[i][c] / n;
        error += (mean - r) * (mean - r) / relative_to(r);
        variance += (level.squares[i][c] / n - mean * mean) * n / (n - 1.0) / relative_to(r);
      }
    const double values = 3.0 * static_cast<double>(level.pixels.size());
    point.variance = level.runs > 1 ? variance / values : infinity;
    point.bias2 = level.runs > 1 ? error / values - point.variance / n - reference_.relmse : infinity;
    series.points.push_back(point);
  }
  if (last == nullptr) return series;
  series.difference.resize(last->pixels.size());
  for (std::size_t i = 0; i < last->pixels.size(); ++i) {
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) {
      const double r = reference_.picture.pixels[3 * i + static_cast<std::size_t>(c)];
      sum += (last->pixels[i][c] / last->runs - r) / std::sqrt(relative_to(r));
    }
    series.difference[i] = static_cast<float>(sum / 3.0);
  }
  return series;
}

BenchSeries measure_series(const BenchSubject& subject, IntegratorKind kind, const BenchReference& reference,
                           const SeriesBudget& budget, const std::function<void(double)>& report) {
  const Stopwatch spent;
  SeriesCollector collector(subject.name, std::string(name_of_value<IntegratorKind>(integrator_names, kind)),
                            reference);
  Plan plan = plan_render(subject.needs, kind, subject.limits);
  fit_to_view(plan, kind, subject.scene, subject.camera, {{0, 0}, {subject.width, subject.height}},
              subject.limits, 0);
  for (int run = 0; run < budget.seeds && !interrupt_requested(); ++run) {
    const auto seed = static_cast<std::uint32_t>(run);
    collector.begin_run(seed);
    reset_peak_memory();
    const Stopwatch stopwatch;
    Elapsed time;  // without that of measuring
    Stopwatch part;
    RadiosityOptions radiosity;
    radiosity.seed = seed;
    const PixelWindow window{{0, 0}, {subject.width, subject.height}};
    PassOneJob job{.scene = subject.scene,
                   .plan = plan,
                   .integrator = kind,
                   .radiosity = radiosity_options(kind, subject.limits, subject.camera, window, radiosity)};
    // As in a render of which the number of samples is not known.
    const bool is_judged =
        plan.radiosity_pass && kind == IntegratorKind::two_pass && !is_clamped(subject.limits);
    const PreparedPassOne prepared =
        is_judged ? prepare_within_bias(std::move(job), subject.camera, window, subject.limits,
                                        bias_goal({}, window, 1), [](const std::string&) {})
                  : prepare_pass_one(std::move(job));
    const auto integrator = make_integrator(kind, subject.scene, prepared.view(), subject.limits);
    time += part.elapsed();
    const Elapsed pass_one = prepared.time();
    Film film(subject.width, subject.height);
    std::uint64_t rays = 0;
    const int last_samples = collector.last_samples();  // of the first run
    for (int begin = 0, end = 1;; begin = end, end *= 2) {
      part = Stopwatch();
      Film added(subject.width, subject.height);
      const RenderOutcome outcome = render_image({.integrator = *integrator,
                                                  .camera = subject.camera,
                                                  .filter = box_filter(),
                                                  .goal = {end - begin, 0.0, 0.0},
                                                  .seed = seed,
                                                  .cone = subject.cone,
                                                  .first_sample = static_cast<std::uint32_t>(begin)},
                                                 added);
      if (interrupt_requested()) break;
      film.merge(added);
      time += part.elapsed();
      rays += outcome.counts.rays + outcome.counts.shadow_rays;
      const BenchPoint& point = collector.add(
          {.samples_per_pixel = end, .time = time, .pass_one = pass_one, .rays = rays}, film.resolve());
      if (report) report(spent.seconds());
      // The next doubling takes twice as long as this one.
      const bool is_enough =
          run > 0 ? end >= last_samples
                  : stopwatch.seconds() + 2.0 * part.seconds() > budget.seconds || point.relmse < budget.relmse;
      if (is_enough || end >= most_samples_per_pixel) break;
    }
    collector.end_run(peak_memory_bytes());
  }
  return collector.finish();
}

double time_to_error(const std::vector<SeriesPoint>& points, double relmse) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].relmse > relmse) continue;
    if (i == 0 || points[i].relmse <= 0.0) return points[i].time.cpu_seconds;
    const SeriesPoint &a = points[i - 1], &b = points[i];
    const double along = std::log(a.relmse / relmse) / std::log(a.relmse / b.relmse);
    return a.time.cpu_seconds * std::pow(b.time.cpu_seconds / a.time.cpu_seconds, along);
  }
  return infinity;
}

}  // namespace twopass
