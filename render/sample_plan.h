// When to stop, and how the samples are divided among the pixels until then.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "render/image/film.h"

namespace twopass {

/// When to stop. The first goal that is met ends the render; zero means no such goal.
struct SamplingGoal {
  int samples_per_pixel = 0;  ///< on average
  double seconds = 0.0;
  double relative_error = 0.0;  ///< of Film::noise()
};

/// Most samples that one pixel gets, and where a render without a goal of samples stops at last.
inline constexpr int most_samples_per_pixel = 1 << 16;

/// The samples [begin, end) of a pixel.
struct SampleRange {
  std::uint32_t begin, end;
};

/// How much each pixel of a picture deserves, from a pilot of equally many samples of each. The mean of
/// v_p / n_p over the pixels, v_p the relative variance of a sample, is least for a given sum of the n_p where
/// n_p is proportional to sqrt(v_p) (Neyman 1934, section 3.3; Cauchy and Schwarz: never worse than equal
/// n_p). sqrt(v_p) is the mean of those of the pixels around p, never of p itself: what a
/// pixel has seen has no influence on how often it is sampled, so that its mean stays unbiased. (Only how long
/// the whole picture is sampled depends on all pixels, as in every render to a goal of noise.)
class SampleShares {
 public:
  /// REQUIRES: every pixel of the pilot has had the same number of samples, in at least two batches.
  explicit SampleShares(const Film& pilot);
  /// The same again. REQUIRES: what levels(), variances() and pilot_samples() were.
  SampleShares(std::vector<std::uint8_t> levels, std::span<const double> variances,
               std::uint32_t pilot_samples);

  /// One for each pixel.
  [[nodiscard]] const std::vector<std::uint8_t>& pixel_levels() const { return levels_; }
  /// For each level, the sum of the relative variances of its pixels.
  [[nodiscard]] std::vector<double> variances() const;
  [[nodiscard]] std::uint32_t pilot_samples() const { return pilot_samples_; }
  /// How many levels there are.
  static constexpr std::size_t level_count() { return levels; }

  /// The samples that pixel i has at a step: those of the pilot times a power of two or one and a half, for
  /// Sobol points are best there. From each step to the next some of the pixels, evenly over the range of
  /// shares, go up.
  [[nodiscard]] std::uint32_t samples(std::size_t i, int step) const { return samples_of(levels_[i], step); }
  /// Samples of the whole picture at a step.
  [[nodiscard]] double total(int step) const;
  /// The relMSE to be expected at a step.
  [[nodiscard]] double expected_relmse(int step) const;
  /// By how much equal numbers of samples, as many in all, would have the larger relMSE.
  [[nodiscard]] double gain(int step) const;
  /// The first step from `from` on with at most the given relMSE, or the last that needs at most `most`
  /// samples.
  [[nodiscard]] int step_for(double relmse, int from, double most) const;

 private:
  [[nodiscard]] std::uint32_t samples_of(int level, int step) const;

  static constexpr int octave = 16, most_octaves = 4, levels = 2 * most_octaves * octave + 1;
  struct Bin {
    double pixels = 0.0, variance = 0.0;  // the latter summed over the pixels
  };
  std::uint32_t pilot_samples_;
  std::vector<std::uint8_t> levels_;  // log2 of the share, in steps; the middle one is the mean share
  std::array<Bin, levels> bins_;
};

/// Where a plan stands, for it to be taken up again.
struct PlanState {
  bool in_pass = false;  ///< a pass has been planned and may not be finished
  double before = 0.0, after = 0.0, error = std::numeric_limits<double>::infinity();
  int step = 0, pilot_samples = 16;
  std::vector<std::uint8_t> levels{};  ///< of SampleShares; none before the end of the pilot
  std::vector<double> variances{};     ///< the same
  std::uint32_t shares_of = 0;         ///< samples of each pixel in the pilot that the shares are of
};

/// The passes of a render. Without a goal of noise all pixels are sampled alike; with one, by SampleShares,
/// after a pilot that has at least an eighth of the samples that the picture seems to need, if that seems to
/// gain a twentieth.
class SamplePlan {
 public:
  /// REQUIRES: goal and film outlive the plan; the film is empty, and filled by what the plan says alone.
  SamplePlan(const SamplingGoal& goal, const Film& film);
  /// Goes on where another plan has stood. REQUIRES: the film is as that plan left it, but the pass that it was
  /// in may have been rendered only for some of the pixels.
  SamplePlan(const SamplingGoal& goal, const Film& film, const PlanState& state);

  /// REQUIRES: of a pass that was planned, `in_pass` tells whether it is still to be finished.
  [[nodiscard]] PlanState state(bool in_pass) const;

  /// Plans the next pass, after the last one has been rendered. False: a goal is met.
  bool next();
  /// The samples of a pixel in this pass; none where begin >= end.
  [[nodiscard]] SampleRange range(int x, int y) const;
  /// Samples a pixel before and after this pass, on average.
  [[nodiscard]] double mean_before() const { return before_; }
  [[nodiscard]] double mean_after() const { return after_; }
  /// Why next() was false: "noise" or "samples".
  [[nodiscard]] const std::string& stop_reason() const { return stop_reason_; }
  /// The upper bound of the film's error before this pass; infinite while it is unknown.
  [[nodiscard]] double error() const { return error_; }

 private:
  [[nodiscard]] double limit() const;
  [[nodiscard]] double pixels() const;
  bool next_uniform();
  bool next_shared();
  void end_pilot();

  const SamplingGoal& goal_;
  const Film& film_;
  std::vector<SampleShares> shares_;  // none before the end of the pilot
  int step_ = 0;
  int pilot_samples_;
  double before_ = 0.0, after_ = 0.0, error_ = std::numeric_limits<double>::infinity();
  std::string stop_reason_;
};

}  // namespace twopass
