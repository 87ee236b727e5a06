#include "render/sample_plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "render/core/parallel.h"

namespace twopass {

namespace {

constexpr double most_variance = 1e30;  // infinities would leave nothing for the others

// What the pixels of some rows of a pilot, and those around them, say of their noise.
class Surroundings {
 public:
  Surroundings(const Film& pilot, std::span<const Around> around, int begin, int end)
      : pilot_(pilot), around_(around), first_(std::max(begin - radius, 0)) {
    const int last = std::min(end + radius, pilot.height());
    noise_.reserve(static_cast<std::size_t>(last - first_) * static_cast<std::size_t>(pilot.width()));
    for (int y = first_; y < last; ++y)
      for (int x = 0; x < pilot.width(); ++x) noise_.push_back(pilot.pixel(x, y).noise());
  }
  [[nodiscard]] double variance(int x, int y) const { return relative(x, y, around(x, y)); }
  // The mean root of the variances of the pixels around (x, y), as they are without it: nothing of the result
  // depends on that pixel. 1 where there are no others.
  [[nodiscard]] double share(int x, int y) const {
    const C3d& own = noise(x, y).mean;
    double sum = 0.0;
    int count = 0;
    for (int j = std::max(y - radius, 0); j <= std::min(y + radius, pilot_.height() - 1); ++j)
      for (int i = std::max(x - radius, 0); i <= std::min(x + radius, pilot_.width() - 1); ++i) {
        if (i == x && j == y) continue;
        Around without = around(i, j);
        without.sum -= own;
        --without.count;
        sum += std::sqrt(relative(i, j, without));
        ++count;
      }
    return count > 0 ? sum / count : 1.0;
  }

 private:
  static constexpr int radius = Film::around_radius;
  [[nodiscard]] double relative(int x, int y, const Around& around) const {
    return std::min(noise(x, y).relative(around), most_variance);
  }
  [[nodiscard]] const PixelNoise& noise(int x, int y) const { return noise_[pilot_.index(x, y - first_)]; }
  [[nodiscard]] const Around& around(int x, int y) const { return around_[pilot_.index(x, y)]; }

  const Film& pilot_;
  std::span<const Around> around_;
  int first_;
  std::vector<PixelNoise> noise_;  // of the rows from first_ on
};

}  // namespace

SampleShares::SampleShares(const Film& pilot)
    : pilot_samples_(static_cast<std::uint32_t>(pilot.pixel(0, 0).samples)) {
  const std::vector<Around> around = pilot.surroundings();
  const std::size_t pixels = around.size();
  std::vector<double> variances(pixels), shares(pixels);
  constexpr std::size_t band = 32;
  parallel_for(static_cast<std::size_t>(pilot.height()), band, [&](std::size_t begin, std::size_t end) {
    const int first = static_cast<int>(begin), last = static_cast<int>(end);
    const Surroundings surroundings(pilot, around, first, last);
    for (int y = first; y < last; ++y)
      for (int x = 0; x < pilot.width(); ++x) {
        const std::size_t i = pilot.index(x, y);
        variances[i] = surroundings.variance(x, y);
        shares[i] = surroundings.share(x, y);
      }
  });
  const double mean_share =
      std::accumulate(shares.begin(), shares.end(), 0.0) / static_cast<double>(shares.size());
  // Between a sixteenth and sixteen times the mean: where the pilot saw no scatter there may be some, and
  // where it saw much that may have been one bright sample.
  constexpr int middle = most_octaves * octave;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double relative = mean_share > 0.0 ? shares[i] / mean_share : 1.0;
    const double level = relative > 0.0 ? octave * std::log2(relative) : -middle;
    levels_.push_back(
        static_cast<std::uint8_t>(std::lround(std::clamp<double>(level, -middle, middle)) + middle));
    Bin& bin = bins_[levels_.back()];
    bin.pixels += 1.0;
    bin.variance += variances[i];
  }
}

SampleShares::SampleShares(std::vector<std::uint8_t> pixel_levels, std::span<const double> variances,
                           std::uint32_t pilot_samples)
    : pilot_samples_(pilot_samples), levels_(std::move(pixel_levels)) {
  for (const std::uint8_t level : levels_) bins_[level].pixels += 1.0;
  for (std::size_t level = 0; level < bins_.size(); ++level) bins_[level].variance = variances[level];
}

std::vector<double> SampleShares::variances() const {
  std::vector<double> result;
  for (const Bin& bin : bins_) result.push_back(bin.variance);
  return result;
}

std::uint32_t SampleShares::samples_of(int level, int step) const {
  const int above = std::max(level + step - 2 * most_octaves * octave, 0);
  std::uint64_t samples = std::uint64_t{pilot_samples_} << std::min(above / octave, 32);
  if (above % octave >= octave / 2) samples += samples / 2;
  return static_cast<std::uint32_t>(std::min(samples, std::uint64_t{most_samples_per_pixel}));
}

double SampleShares::total(int step) const {
  double sum = 0.0;
  for (int level = 0; level < levels; ++level)
    sum += bins_[static_cast<std::size_t>(level)].pixels * samples_of(level, step);
  return sum;
}

double SampleShares::expected_relmse(int step) const {
  double sum = 0.0;
  for (int level = 0; level < levels; ++level)
    sum += bins_[static_cast<std::size_t>(level)].variance / samples_of(level, step);
  return sum / static_cast<double>(levels_.size());
}

double SampleShares::gain(int step) const {
  double variance = 0.0;
  for (const Bin& bin : bins_) variance += bin.variance;
  const double shared = expected_relmse(step) * total(step);
  return shared > 0.0 ? variance / shared : 1.0;
}

int SampleShares::step_for(double relmse, int from, double most) const {
  constexpr int last = (2 * most_octaves + 16) * octave;  // here every pixel has the most that it may have
  int step = from;
  while (step < last && expected_relmse(step) > relmse && total(step + 1) <= most) ++step;
  return step;
}

// A million samples tell how noisy a picture is, however many pixels they belong to; but four of each.
SamplePlan::SamplePlan(const SamplingGoal& goal, const Film& film)
    : goal_(goal), film_(film), pilot_samples_(16) {
  while (pilot_samples_ > 4 && pilot_samples_ / 2 * pixels() >= 0x1p20) pilot_samples_ /= 2;
}

SamplePlan::SamplePlan(const SamplingGoal& goal, const Film& film, const PlanState& state)
    : goal_(goal),
      film_(film),
      step_(state.step),
      pilot_samples_(state.pilot_samples),
      before_(state.before),
      after_(state.after),
      error_(state.error) {
  if (!state.levels.empty()) shares_.emplace_back(state.levels, state.variances, state.shares_of);
}

PlanState SamplePlan::state(bool in_pass) const {
  PlanState state{.in_pass = in_pass,
                  .before = before_,
                  .after = after_,
                  .error = error_,
                  .step = step_,
                  .pilot_samples = pilot_samples_};
  if (!shares_.empty()) {
    state.levels = shares_.front().pixel_levels();
    state.variances = shares_.front().variances();
    state.shares_of = shares_.front().pilot_samples();
  }
  return state;
}

double SamplePlan::pixels() const { return static_cast<double>(film_.width()) * film_.height(); }

double SamplePlan::limit() const {
  return goal_.samples_per_pixel > 0 ? goal_.samples_per_pixel : most_samples_per_pixel;
}

bool SamplePlan::next() {
  before_ = after_;
  if (goal_.relative_error > 0.0 && before_ > 0.0) {
    // Its upper bound: a render ends when its error is below the goal, not when its estimate happens to be.
    error_ = film_.noise().upper_bound();
    if (error_ <= goal_.relative_error) {
      stop_reason_ = "noise";
      return false;
    }
    if (shares_.empty() && before_ >= pilot_samples_) end_pilot();
  }
  if (shares_.empty() ? next_uniform() : next_shared()) return true;
  stop_reason_ = "samples";
  return false;
}

// Passes are the batches of the error estimate: enough of them to be one, few enough to cost nothing.
bool SamplePlan::next_uniform() {
  const double wanted = goal_.relative_error > 0.0 || goal_.samples_per_pixel == 0
                            ? std::min(std::max(before_, pilot_samples_ / 2.0), 8.0)
                            : std::clamp(std::floor(limit() / 8.0), 1.0, 16.0);
  after_ = std::min(before_ + wanted, limit());
  return after_ > before_;
}

void SamplePlan::end_pilot() {
  constexpr double most_growth = 8.0, least_gain = 1.05;
  SampleShares shares(film_);
  const int step = shares.step_for(goal_.relative_error * goal_.relative_error, 0, limit() * pixels());
  if (shares.total(step) > most_growth * before_ * pixels() || shares.gain(step) < least_gain)
    pilot_samples_ *= 2;
  else
    shares_.push_back(std::move(shares));
}

// At most twice the samples there are, and then another look at the error.
bool SamplePlan::next_shared() {
  const SampleShares& shares = shares_.front();
  const double goal = goal_.relative_error / error_;
  const double most = std::min(2.0 * shares.total(step_), limit() * pixels());
  step_ = shares.step_for(shares.expected_relmse(step_) * goal * goal, step_, most);
  after_ = shares.total(step_) / pixels();
  return after_ > before_;
}

SampleRange SamplePlan::range(int x, int y) const {
  const auto begin = static_cast<std::uint32_t>(film_.pixel(x, y).samples);
  if (shares_.empty()) return {begin, static_cast<std::uint32_t>(after_)};
  const std::size_t i =
      static_cast<std::size_t>(y) * static_cast<std::size_t>(film_.width()) + static_cast<std::size_t>(x);
  return {begin, shares_.front().samples(i, step_)};
}

}  // namespace twopass
