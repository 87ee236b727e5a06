// Light along rays: the contract of every integrator. Knows no pixel, no file, no thread.
#pragma once

#include <cstdint>
#include <span>

#include "render/core/sampler.h"
#include "render/scene/ray_cone.h"
#include "render/scene/scene.h"

namespace twopass {

/// What rendering has cost so far; each thread has its own.
struct RayCounts {
  std::uint64_t rays = 0;          ///< nearest-hit queries
  std::uint64_t shadow_rays = 0;   ///< visibility queries
  std::uint64_t escaped_rays = 0;  ///< nearest-hit queries that met nothing
};

/// Whether so few of the rays escaped that they may have found cracks between surfaces that were meant to be
/// closed. Openings that anyone would make on purpose let more rays out.
inline bool may_have_cracks(const RayCounts& counts) {
  constexpr double most_through_cracks = 1e-4;
  return counts.escaped_rays > 0 &&
         static_cast<double>(counts.escaped_rays) < most_through_cracks * static_cast<double>(counts.rays);
}

/// What one camera ray sees.
struct Seen {
  C3f radiance{0.0f};  ///< W/(m2 sr)
  float alpha = 0.0f;  ///< 1 where the ray meets a surface, 0 where it escapes
};

struct SampleLayers;
class ReadErrors;

/// One camera ray, the numbers that its path may draw, and room for what it sees.
struct PathSample {
  Ray ray;  ///< direction of unit length
  Sampler sampler;
  Seen seen{};
  float reach = infinity_f;  ///< what lies further along the ray is not seen
  RayCone cone{};            ///< of the ray; integrators widen it. Closed: textures are looked at in points.
  SampleLayers* layers = nullptr;  ///< filled in, too, where there is one
  ReadErrors* errors = nullptr;    ///< filled in by `Unbiased`, too, where there are such (I20)
};

/// Limits on the paths that carry light. Edges are counted as in Mitsuba: 1 is emitted light only, 2 direct
/// light.
struct PathLimits {
  int max_depth = -1;                 ///< most edges; -1: no limit
  int rr_depth = 5;                   ///< edges before Russian roulette starts
  bool hide_emitters = false;         ///< lights that the camera sees directly stay dark
  float clamp_direct = infinity_f;    ///< most radiance that a path of two edges adds to a sample, W/(m2 sr)
  float clamp_indirect = infinity_f;  ///< the same of longer paths
};

/// Samples that are traced side by side (I6). Integrators take any number of them; multiples of this many, of
/// neighbouring rays, are the fastest.
inline constexpr std::size_t bundle_size = 256;

class Integrator {
 public:
  virtual ~Integrator() = default;
  /// Writes into `seen` of each sample (and `layers`, if any: what is seen does not depend on it) an estimate
  /// of the radiance arriving along its ray from where it points. Const and thread-safe. What a sample sees is
  /// a function of its ray and its sampler; where surfaces coincide, the samples beside it may decide which of
  /// them it meets (I8).
  virtual void trace(std::span<PathSample> samples, RayCounts& counts) const = 0;

  /// The same for one ray.
  Seen radiance(const Ray& ray, Sampler& sampler, RayCounts& counts) const {
    PathSample sample{ray, sampler};
    trace({&sample, 1}, counts);
    sampler = sample.sampler;
    return sample.seen;
  }
};

}  // namespace twopass
