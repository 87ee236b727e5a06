// The certificate: how much a picture's mean is off because its integrator is biased, measured against one that
// is not, with an interval of confidence.
#pragma once

#include <optional>
#include <vector>

#include "integrators/integrator.h"
#include "radiosity/adaptive.h"
#include "render/scene/camera.h"

namespace twopass {

struct CertificateJob {
  const Integrator& biased;
  const Integrator& unbiased;
  const Camera& camera;
  int width = 0, height = 0;  ///< of the part of the picture that was rendered
  V2i corner{0, 0};           ///< and where it begins
  std::uint32_t seed = 0;
  double most_rays = 0.0;      ///< about as many, of all kinds; a pilot of 2048 samples is cast in any case
  double close_enough = 1e-3;  ///< no more samples than this half width of the interval seems to need
  std::size_t elements = 0;    ///< of the solution that both read; 0: nobody asks which of them are wrong
};

/// What there is to say about a picture's mean over all pixels and channels, relative to the truth's: positive
/// if the picture is too bright.
struct Certificate {
  double mean = 0.0;  ///< the estimate; infinite where the estimate of the truth is not above 0
  double ci95 = 0.0;  ///< half width of its 95 % interval; infinite with `mean`
  std::uint64_t samples = 0;
  RayCounts counts;  ///< of both, and of a guide that was made for it
  /// Sums over the samples of independent batches.
  struct Batch {
    double biased = 0.0, unbiased = 0.0;
  };
  std::vector<Batch> of_batch{};
  /// Whether, at the level of 95 %, the mean is off by more than so much of the truth's. The picture of a place
  /// that is dark in truth is, whatever light it has (I14).
  [[nodiscard]] bool is_certainly_beyond(double bias) const;
  /// By element, relative to the truth's mean, or to the picture's where that is not above 0: what the picture
  /// has from there, and of that, what is too much (I20).
  std::vector<ElementError> of_element{};
};

/// Both integrators see the same camera rays and draw the same random numbers, so that what they do alike
/// cancels (I13). The same on any number of threads. None where the user interrupts, or where nothing can be
/// said: fewer than 32 samples differed, because the picture is black but for a few places, or hardly reads a
/// solution.
std::optional<Certificate> certify(const CertificateJob& job);

}  // namespace twopass
