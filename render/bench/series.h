// Error against time and samples: one way to render, several seeds, against a reference.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "render/bench/reference.h"
#include "render/stopwatch.h"

namespace twopass {

/// What a picture is like, some samples on.
struct BenchPoint {
  int samples_per_pixel = 0;
  Elapsed time{};  ///< since the beginning, pass one included
  Elapsed pass_one{};
  std::uint64_t rays = 0;  ///< of pass two
  double relmse = 0.0;     ///< the reference's own taken off, as of mse
  double mse = 0.0;
  double smape = 0.0;
  double flip = 0.0;
  C3d energy_ratio{1.0, 1.0, 1.0};
};

struct BenchRun {
  std::uint32_t seed = 0;
  std::size_t memory_bytes = 0;  ///< most that the process held during the run; 0: unknown
  std::vector<BenchPoint> points;
};

/// The mean of the runs at one number of samples.
struct SeriesPoint : BenchPoint {
  int runs = 0;
  /// The parts of relmse, by how the runs differ; of at least two runs, else infinite. bias2 is unbiased, hence
  /// below zero at times.
  double bias2 = 0.0, variance = 0.0;
};

/// One way to render one scene.
struct BenchSeries {
  std::string scene, method;  ///< an integrator, or a peer
  std::vector<BenchRun> runs;
  std::vector<SeriesPoint> points;  ///< where all the runs are
  Image picture;                    ///< of the first run, at its end
  std::vector<float>
      difference;  ///< mean of the runs less the reference over sqrt(r^2 + 0.01), at the last point
};

/// Collects runs of one method into a series.
class SeriesCollector {
 public:
  /// REQUIRES: the reference outlives the collector.
  SeriesCollector(std::string scene, std::string method, const BenchReference& reference)
      : series_{std::move(scene), std::move(method), {}, {}, {}, {}}, reference_(reference) {}

  void begin_run(std::uint32_t seed);
  /// A picture of the present run, in the order of its samples: fills in the measures of `point` and keeps it.
  /// Later runs may have no other numbers of samples than the first.
  const BenchPoint& add(BenchPoint point, const Image& picture);
  void end_run(std::size_t memory_bytes);
  /// Number of samples at which the first run stopped; 0 while there is none.
  [[nodiscard]] int last_samples() const;
  /// The mean of all runs that have ended.
  [[nodiscard]] BenchSeries finish() const;

 private:
  // Sums over the runs at one number of samples.
  struct Level {
    int samples_per_pixel = 0, runs = 0;
    BenchPoint sum;
    std::vector<C3d> pixels, squares;
  };
  BenchSeries series_;
  const BenchReference& reference_;
  std::vector<Level> levels_;
  std::size_t next_level_ = 0;
};

/// Renders with an integrator, doubling the samples, until the next doubling would pass `seconds` or the relMSE
/// is below `relmse`; the first run decides where the others end. Ends early when the user interrupts; a run
/// that was cut short counts as far as it went. `report` is called with the seconds that are spent.
struct SeriesBudget {
  double seconds = 0.0;
  double relmse = 0.0;
  int seeds = 1;
};
BenchSeries measure_series(const BenchSubject& subject, IntegratorKind kind, const BenchReference& reference,
                           const SeriesBudget& budget, const std::function<void(double)>& report);

/// CPU seconds until a series reaches a relMSE, between two points along the straight line of logarithms;
/// infinite if it does not. REQUIRES: relmse > 0.
double time_to_error(const std::vector<SeriesPoint>& points, double relmse);

}  // namespace twopass
