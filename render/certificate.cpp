#include "render/certificate.h"

#include <array>
#include <cmath>
#include <vector>

#include "integrators/read_errors.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"

namespace twopass {

namespace {

// Independent batches, and Student's t for 95 % with one degree of freedom less.
constexpr std::uint32_t batches = 32;
constexpr double student_t = 2.0395;
constexpr std::uint32_t pilot_samples = 64;  // a batch
constexpr std::uint32_t most_samples = 1u << 24;
// Samples on which the integrators disagree, without which the scatter of the batches means nothing.
constexpr std::uint64_t least_different = 32;
// So that the samples are none of the picture's.
constexpr std::uint32_t own_seeds = 0x9d5c0f3bu;

struct Sums {
  double biased = 0.0, unbiased = 0.0;
  std::uint64_t different = 0;  // samples
  RayCounts counts;
  void add(const Sums& other) {
    biased += other.biased;
    unbiased += other.unbiased;
    different += other.different;
    counts.rays += other.counts.rays;
    counts.shadow_rays += other.counts.shadow_rays;
  }
};

double seen_by(const PathSample& sample) {
  const double value = mean_component(sample.seen.radiance);
  return std::isfinite(value) ? value : 0.0;
}

// Samples [begin, end) of a batch. A batch is one sequence of Sobol points over picture and paths, scrambled by
// itself: evenly spread, and independent of the other batches.
// `read`: what the samples say of the elements; null: nobody asks.
Sums trace(const CertificateJob& job, std::uint32_t batch, std::uint32_t begin, std::uint32_t end,
           std::vector<ReadError>* read) {
  std::vector<PathSample> samples;
  for (std::uint32_t i = begin; i < end; ++i) {
    Sampler sampler(job.seed ^ own_seeds, batch, i);
    const V2f u = sampler.next_2d();
    const V2f at(static_cast<float>(job.corner.x) + u.x * static_cast<float>(job.width),
                 static_cast<float>(job.corner.y) + u.y * static_cast<float>(job.height));
    const CameraRay seen = job.camera.has_lens() ? job.camera.ray(at, sampler.next_2d()) : job.camera.ray(at);
    samples.push_back({seen.ray, sampler, {}, seen.reach});
  }
  std::vector<PathSample> same = samples;
  Sums sums;
  job.biased.trace(samples, sums.counts);
  std::vector<ReadErrors> errors(read ? same.size() : 0);
  for (std::size_t i = 0; i < errors.size(); ++i) same[i].errors = &errors[i];
  job.unbiased.trace(same, sums.counts);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double biased = seen_by(samples[i]), unbiased = seen_by(same[i]);
    sums.biased += biased;
    sums.unbiased += unbiased;
    if (biased != unbiased) ++sums.different;
    if (!read || !std::isfinite(mean_component(same[i].seen.radiance))) continue;
    errors[i].end(unbiased);
    read->insert(read->end(), errors[i].of_vertex().begin(), errors[i].of_vertex().end());
  }
  return sums;
}

// Sums over all samples, by batch, and of what they read by element.
struct AllSums {
  std::array<Sums, batches> of_batch{};
  std::vector<ElementError> of_element;
};

// The samples [begin, end) of every batch, added to what there is. False: interrupted.
bool trace_all(const CertificateJob& job, std::uint32_t begin, std::uint32_t end, AllSums& all) {
  constexpr auto grain = static_cast<std::uint32_t>(bundle_size);
  // What so many pieces read is kept at a time, and added up in order.
  constexpr std::size_t most_pieces = 1024;
  const std::uint32_t pieces = (end - begin + grain - 1) / grain;
  std::vector<Sums> of_piece(std::size_t{batches} * pieces);
  std::vector<std::vector<ReadError>> read(all.of_element.empty() ? 0 : std::min(most_pieces, of_piece.size()));
  for (std::size_t start = 0; start < of_piece.size(); start += most_pieces) {
    const std::size_t stop = std::min(start + most_pieces, of_piece.size());
    parallel_for(stop - start, 1, [&](std::size_t first, std::size_t past) {
      for (std::size_t k = start + first; k < start + past && !interrupt_requested(); ++k) {
        const auto batch = static_cast<std::uint32_t>(k / pieces);
        const std::uint32_t from = begin + static_cast<std::uint32_t>(k % pieces) * grain;
        of_piece[k] =
            trace(job, batch, from, std::min(from + grain, end), read.empty() ? nullptr : &read[k - start]);
      }
    });
    for (std::vector<ReadError>& errors : read) {
      for (const ReadError& error : errors) all.of_element[error.element].add(error.carried, error.error);
      errors.clear();
    }
  }
  for (std::size_t k = 0; k < of_piece.size(); ++k) all.of_batch[k / pieces].add(of_piece[k]);
  return !interrupt_requested();
}

// The mean over the batches of what there is biased too much, if the bias were `bias`, and the half width of
// its interval.
struct Excess {
  double mean, half_width;
};
Excess excess_over(double bias, const std::vector<Certificate::Batch>& of_batch) {
  double sum = 0.0, squares = 0.0;
  for (const auto& [biased, unbiased] : of_batch) sum += biased - (1.0 + bias) * unbiased;
  const double mean = sum / batches;
  for (const auto& [biased, unbiased] : of_batch)
    squares += std::pow(biased - (1.0 + bias) * unbiased - mean, 2.0);
  return {mean, student_t * std::sqrt(squares / (batches - 1) / batches)};
}

// The quotient of the sums, and its interval from the scatter of the batches (I14).
std::optional<Certificate> conclude(const AllSums& sums_of, std::uint32_t samples) {
  const auto& [of_batch, of_element] = sums_of;
  Sums all;
  for (const Sums& sums : of_batch) all.add(sums);
  if (all.different < least_different) return std::nullopt;
  Certificate result;
  for (const Sums& sums : of_batch) result.of_batch.push_back({sums.biased, sums.unbiased});
  result.mean = result.ci95 = infinity_f;
  if (all.unbiased > 0.0) {
    result.mean = (all.biased - all.unbiased) / all.unbiased;
    result.ci95 = excess_over(result.mean, result.of_batch).half_width / (all.unbiased / batches);
  }
  result.samples = std::uint64_t{samples} * batches;
  result.counts = all.counts;
  result.of_element = of_element;
  if (const double mean = all.unbiased > 0.0 ? all.unbiased : all.biased; mean > 0.0)
    for (ElementError& error : result.of_element) error.scale(1.0 / mean);
  return result;
}

}  // namespace

bool Certificate::is_certainly_beyond(double bias) const {
  const Excess above = excess_over(bias, of_batch), below = excess_over(-bias, of_batch);
  return above.mean > above.half_width || -below.mean > below.half_width;
}

std::optional<Certificate> certify(const CertificateJob& job) {
  AllSums all;
  all.of_element.resize(job.elements);
  if (!trace_all(job, 0, pilot_samples, all)) return std::nullopt;
  const std::optional<Certificate> pilot = conclude(all, pilot_samples);
  // How many is decided once: samples that are added until the interval looks good would make it look too good.
  double rays = 0.0;
  for (const Sums& sums : all.of_batch) rays += static_cast<double>(sums.counts.rays + sums.counts.shadow_rays);
  const double wanted = pilot ? std::pow(pilot->ci95 / job.close_enough, 2.0) : infinity_f;
  const double factor = std::min({wanted, job.most_rays / rays, double{most_samples} / pilot_samples});
  const auto samples = static_cast<std::uint32_t>(pilot_samples * std::max(factor, 1.0));
  if (samples > pilot_samples && !trace_all(job, pilot_samples, samples, all)) return std::nullopt;
  return conclude(all, samples);
}

}  // namespace twopass
