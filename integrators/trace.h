// Paths in lock step: a bundle of them moves edge by edge, so that its rays are cast in packets (I6).
#pragma once

#include <array>

#include "integrators/walk.h"

namespace twopass {

/// The driver of a bundle of paths. An integrator is what it does at a vertex: `at_vertex(walk)` may add
/// radiance, sample the lights once, and draw the next direction; it returns whether the path goes on, as
/// `walk.leave()` does. Light sampling is linear, so no path waits for its shadow ray: what the ray would carry
/// is kept beside it, and is added or not.
class Bundle {
 public:
  /// REQUIRES: at most bundle_size samples, which outlive the bundle.
  Bundle(const Scene& scene, std::span<PathSample> samples) : scene_(scene), samples_(samples) {}

  template <class AtVertex>
  void trace(const PathLimits& limits, RayCounts& counts, const AtVertex& at_vertex) {
    for (live_ = 0; live_ < samples_.size(); ++live_) {
      samples_[live_].seen = {};
      rays_[live_] = samples_[live_].ray;
      lanes_[live_] = static_cast<std::uint8_t>(live_);
    }
    for (int edges = 1; live_ > 0; ++edges) {
      counts.rays += live_;
      scene_.caster().intersect({rays_.data(), live_}, hits_, kind_of_edge(edges));
      if (edges == 1) clip();
      counts.escaped_rays += move(limits, edges, at_vertex);
      counts.shadow_rays += connected_;
      add_unoccluded();
    }
  }

 private:
  // Camera rays are alike; what they meet scatters them.
  static Rays kind_of_edge(int edges) { return edges == 1 ? Rays::coherent : Rays::scattered; }
  // The camera does not see what lies beyond its far clipping plane.
  void clip() {
    for (std::size_t i = 0; i < live_; ++i)
      if (hits_[i].t > samples_[i].reach) hits_[i] = {};
  }
  // Takes every live path through the vertex at the end of its edge; those that go on move up in the arrays.
  // The number of paths that escaped.
  template <class AtVertex>
  std::size_t move(const PathLimits& limits, int edges, const AtVertex& at_vertex) {
    const std::size_t arriving = live_;
    std::size_t escaped = 0;
    live_ = connected_ = 0;
    for (std::size_t i = 0; i < arriving; ++i) {
      const std::uint8_t lane = lanes_[i];
      if (hits_[i].escaped()) {
        ++escaped;
        escape(scene_, limits, samples_[lane], carried_[lane], rays_[i], edges);
        continue;
      }
      Walk walk(scene_, limits, samples_[lane], carried_[lane], rays_[i], hits_[i], edges);
      if (!walk.arrive()) continue;
      if (walk.is_hole()) {
        walk.pass();
        lanes_[live_] = lane;
        rays_[live_++] = walk.next_ray();
        continue;
      }
      const bool goes_on = at_vertex(walk);
      if (const auto& connection = walk.connection()) {
        segments_[connected_] = connection->segment;
        light_[connected_] = {connection->radiance, lane};
        ++connected_;
      }
      if (!goes_on) continue;
      lanes_[live_] = lane;
      rays_[live_] = walk.next_ray();
      ++live_;
    }
    return escaped;
  }

  void add_unoccluded() {
    if (scene_.has_see_through()) {
      for (std::size_t i = 0; i < connected_; ++i)
        samples_[light_[i].lane].seen.radiance += light_[i].radiance * scene_.transmittance(segments_[i]);
      return;
    }
    scene_.caster().occluded({segments_.data(), connected_}, occluded_);
    for (std::size_t i = 0; i < connected_; ++i)
      if (!occluded_[i]) samples_[light_[i].lane].seen.radiance += light_[i].radiance;
  }

  struct Light {
    C3f radiance;
    std::uint8_t lane;
  };
  const Scene& scene_;
  std::span<PathSample> samples_;
  std::array<Carried, bundle_size> carried_;  // by lane, that is by sample
  // By path that is still alive.
  std::size_t live_ = 0;
  std::array<std::uint8_t, bundle_size> lanes_;
  std::array<Ray, bundle_size> rays_;
  std::array<Hit, bundle_size> hits_;
  // By light sample of the present vertices.
  std::size_t connected_ = 0;
  std::array<Segment, bundle_size> segments_;
  std::array<Light, bundle_size> light_;
  std::array<bool, bundle_size> occluded_;
};

/// Traces any number of samples, a bundle at a time.
template <class AtVertex>
void trace_bundles(const Scene& scene, const PathLimits& limits, std::span<PathSample> samples,
                   RayCounts& counts, const AtVertex& at_vertex) {
  while (!samples.empty()) {
    const std::size_t count = std::min(samples.size(), bundle_size);
    Bundle(scene, samples.first(count)).trace(limits, counts, at_vertex);
    samples = samples.subspan(count);
  }
}

}  // namespace twopass
