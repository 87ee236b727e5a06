// The walk that all integrators share: a ray, what it carries, and the light that it runs into.
#pragma once

#include "integrators/clamp.h"
#include "integrators/direct_light.h"

namespace twopass {

/// A path being traced from the camera. It remembers how its last direction was drawn, which is all that is
/// needed to weigh light that it meets by chance against light that was sampled on purpose.
class Walk {
 public:
  Walk(const Scene& scene, const PathLimits& limits, const Ray& ray, Sampler& sampler, RayCounts& counts)
      : scene_(scene), limits_(limits), sampler_(sampler), counts_(counts), ray_(ray) {}

  /// Follows the ray to the next surface and adds the light met there to `seen` (I2). False: the path ends,
  /// because it escaped or has all the edges that it may have.
  bool arrive(Seen& seen) {
    ++counts_.rays;
    ++edges_;
    const Hit hit = scene_.caster().intersect(ray_);
    if (hit.escaped()) {
      seen.radiance += clamped(throughput_ * scene_.sky(), edges_, limits_);
      return false;
    }
    distance_ = hit.t;
    point_ = scene_.surface_point(ray_, hit);
    wo_ = point_.shading.to_local(-ray_.direction);
    const C3f& emitted = scene_.emitted_radiance(point_);
    const bool hidden = limits_.hide_emitters && edges_ == 1 && !is_black(emitted);
    if (edges_ == 1) seen.alpha = hidden ? 0.0f : 1.0f;
    if (!is_black(emitted) && !hidden)
      seen.radiance += clamped(throughput_ * emitted * emission_weight(), edges_, limits_);
    return limits_.max_depth < 0 || edges_ < limits_.max_depth;
  }

  /// Radiance that the light sampled at this vertex sends along the path. REQUIRES: the surface is not purely
  /// specular.
  C3f direct_light() {
    if (scene_.lights().empty()) return C3f(0.0f);
    return clamped(throughput_ * sample_direct_light(scene_, point_, bsdf(), wo_, sampler_, counts_),
                   edges_ + 1, limits_);
  }

  /// What the path adds to the sample where the given radiance, reflected here, travels along it.
  [[nodiscard]] C3f carried(const C3f& radiance) const {
    return clamped(throughput_ * radiance, edges_ + 1, limits_);
  }

  /// Draws the next direction, and plays Russian roulette when the path is long (I4). False: the path ends.
  bool leave() {
    const std::optional<BsdfSample> drawn = sample(bsdf(), wo_, sampler_.next_2d());
    if (!drawn) return false;
    const V3f direction = point_.shading.to_world(drawn->wi);
    if (drawn->wi.z * direction.dot(point_.geometric_normal) <= 0.0f) return false;
    throughput_ *= drawn->weight;
    relative_ior_ *= drawn->eta;
    last_pdf_w_ = drawn->pdf_w;
    last_was_specular_ = drawn->is_specular;
    ray_ = {spawn_position(point_, direction), direction};
    return edges_ < limits_.rr_depth || survives();
  }

  [[nodiscard]] const Bsdf& bsdf() const { return scene_.bsdf(point_); }
  [[nodiscard]] const SurfacePoint& point() const { return point_; }
  [[nodiscard]] const C3f& throughput() const { return throughput_; }
  /// Length of the edge that led to the present point.
  [[nodiscard]] float distance() const { return distance_; }

 private:
  // All of the light where the last vertex could not have sampled it (the camera, a specular vertex), else the
  // share of the scattered ray (I3).
  [[nodiscard]] float emission_weight() const {
    if (last_was_specular_) return 1.0f;
    const float light_pdf_w = scene_.lights().pdf_w(ray_.origin, ray_.direction, distance_, point_);
    return power_heuristic(last_pdf_w_, light_pdf_w);
  }

  // The square of the index of refraction undoes the compression of radiance inside glass: it is no loss of
  // importance.
  bool survives() {
    const float survival = std::min(max_component(throughput_) * relative_ior_ * relative_ior_, 0.95f);
    if (sampler_.next_1d() >= survival) return false;
    throughput_ *= 1.0f / survival;
    return true;
  }

  const Scene& scene_;
  const PathLimits& limits_;
  Sampler& sampler_;
  RayCounts& counts_;
  Ray ray_;
  SurfacePoint point_;
  V3f wo_;  // towards where the path came from, local
  C3f throughput_{1.0f};
  float relative_ior_ = 1.0f;
  float distance_ = 0.0f;
  float last_pdf_w_ = 0.0f;
  int edges_ = 0;
  bool last_was_specular_ = true;
};

}  // namespace twopass
