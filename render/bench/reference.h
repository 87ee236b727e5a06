// Converged pictures to measure by, and how far they are from converged themselves.
#pragma once

#include <filesystem>

#include "render/bench/subject.h"
#include "render/image/image.h"

namespace twopass {

struct BenchReference {
  Image picture;              ///< R, G, B, linear Rec.709
  std::vector<C3f> variance;  ///< of each pixel's mean
  double relmse = 0.0;        ///< that it still has itself, by its variance: mean of variance / (r^2 + 0.01)
  double mse = 0.0;           ///< likewise
  double samples_per_pixel = 0.0;
  double seconds = 0.0;  ///< it took
  bool was_cached = false;
};

/// Fills in `relmse` and `mse` from picture and variance.
void estimate_own_error(BenchReference& reference);

/// The reference of a subject: from `folder`, if it holds that of this very scene, camera and size and at least
/// half as much time went into it, else rendered with `path` for `seconds` seconds and kept there. In 16 parts
/// of independent seeds, by whose scatter its own error is known. Throws Error; Interrupted when the user stops
/// it before there are two parts.
BenchReference bench_reference(const BenchSubject& subject, double seconds,
                               const std::filesystem::path& folder);

}  // namespace twopass
