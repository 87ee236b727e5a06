// A path at one of its vertices: the light that it runs into, and where it may go from there.
#pragma once

#include "integrators/direct_light.h"

namespace twopass {

/// What a path carries from vertex to vertex. It remembers how its last direction was drawn, which is all that
/// is needed to weigh light that it meets by chance against light that was sampled on purpose.
struct Carried {
  C3f throughput{1.0f};
  float relative_ior = 1.0f;
  float last_pdf_w = 0.0f;
  bool last_was_specular = true;
  bool has_sampled_lights = false;
};

/// Adds what a path finds that escapes along `ray` (I2).
inline void escape(const Scene& scene, PathSample& sample, const Carried& carried) {
  sample.seen.radiance += carried.throughput * scene.sky();
}

/// A path at the surface where its edge number `edges` ends: the step that all integrators share.
class Walk {
 public:
  /// REQUIRES: !hit.escaped(); everything outlives the walk.
  Walk(const Scene& scene, const PathLimits& limits, PathSample& sample, Carried& carried, const Ray& ray,
       const Hit& hit, int edges)
      : scene_(scene),
        limits_(limits),
        sample_(sample),
        carried_(carried),
        edges_(edges),
        distance_(hit.t),
        point_(scene.surface_point(ray, hit)),
        bsdf_(&scene.bsdf(point_)),
        wo_(point_.shading.to_local(-ray.direction)) {}

  /// Adds the light met here (I2). False: the path has all the edges that it may have. `ray` led here.
  bool arrive(const Ray& ray) {
    const C3f& emitted = scene_.emitted_radiance(point_);
    const bool hidden = limits_.hide_emitters && edges_ == 1 && !is_black(emitted);
    if (edges_ == 1) sample_.seen.alpha = hidden ? 0.0f : 1.0f;
    if (!is_black(emitted) && !hidden)
      sample_.seen.radiance += carried_.throughput * emitted * emission_weight(ray);
    return limits_.max_depth < 0 || edges_ < limits_.max_depth;
  }

  /// Adds radiance that leaves the vertex along the path.
  void add(const C3f& radiance) { sample_.seen.radiance += carried_.throughput * radiance; }

  /// Samples the lights; what they send along the path is added when the shadow ray has been cast. REQUIRES:
  /// the surface is not purely specular.
  void sample_lights() {
    carried_.has_sampled_lights = true;
    if (scene_.lights().empty()) return;
    connection_ = sample_direct_light(scene_, point_, *bsdf_, wo_, sample_.sampler);
    if (connection_) connection_->radiance *= carried_.throughput;
  }

  /// Draws the next direction, and plays Russian roulette when the path is long (I4). False: the path ends.
  bool leave() {
    const std::optional<BsdfSample> drawn = twopass::sample(*bsdf_, wo_, sample_.sampler.next_2d());
    if (!drawn) return false;
    const V3f direction = point_.shading.to_world(drawn->wi);
    if (drawn->wi.z * direction.dot(point_.geometric_normal) <= 0.0f) return false;
    carried_.throughput *= drawn->weight;
    carried_.relative_ior *= drawn->eta;
    carried_.last_pdf_w = drawn->pdf_w;
    carried_.last_was_specular = drawn->is_specular;
    next_ray_ = {spawn_position(point_, direction), direction};
    return edges_ < limits_.rr_depth || survives();
  }

  [[nodiscard]] const Bsdf& bsdf() const { return *bsdf_; }
  [[nodiscard]] const SurfacePoint& point() const { return point_; }
  /// Length of the edge that led to the present vertex.
  [[nodiscard]] float distance() const { return distance_; }
  /// Whether this or an earlier vertex of the path has sampled the lights.
  [[nodiscard]] bool has_sampled_lights() const { return carried_.has_sampled_lights; }
  /// The light sampled at this vertex, if any.
  [[nodiscard]] const std::optional<Connection>& connection() const { return connection_; }
  /// The next edge. REQUIRES: leave() was true.
  [[nodiscard]] const Ray& next_ray() const { return next_ray_; }

 private:
  // All of the light where the last vertex could not have sampled it (the camera, a specular vertex), else the
  // share of the scattered ray (I3).
  [[nodiscard]] float emission_weight(const Ray& ray) const {
    if (carried_.last_was_specular) return 1.0f;
    const float light_pdf_w = scene_.lights().pdf_w(ray.origin, ray.direction, distance_, point_);
    return power_heuristic(carried_.last_pdf_w, light_pdf_w);
  }

  // The square of the index of refraction undoes the compression of radiance inside glass: it is no loss of
  // importance.
  bool survives() {
    C3f& throughput = carried_.throughput;
    const float ior = carried_.relative_ior;
    const float survival = std::min(max_component(throughput) * ior * ior, 0.95f);
    if (sample_.sampler.next_1d() >= survival) return false;
    throughput *= 1.0f / survival;
    return true;
  }

  const Scene& scene_;
  const PathLimits& limits_;
  PathSample& sample_;
  Carried& carried_;
  int edges_;
  float distance_;
  SurfacePoint point_;
  const Bsdf* bsdf_;
  V3f wo_;  // towards where the path came from, local
  std::optional<Connection> connection_;
  Ray next_ray_;
};

}  // namespace twopass
