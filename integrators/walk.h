// A path at one of its vertices: the light that it runs into, and where it may go from there.
#pragma once

#include "integrators/clamp.h"
#include "integrators/direct_light.h"

namespace twopass {

/// What a path carries from vertex to vertex. It remembers how its last direction was drawn, which is all that
/// is needed to weigh light that it meets by chance against light that was sampled on purpose.
struct Carried {
  C3f throughput{1.0f};
  float relative_ior = 1.0f;
  float last_pdf_w = 0.0f;
  Receiver last_receiver;  ///< the vertex that the ray left; set once last_was_specular is false
  bool last_was_specular = true;
  bool gathers = false;        ///< its last direction but for mirrors and glass was drawn from a broad lobe
  int passed = 0;              ///< surfaces that it went straight through; no edge ends there
  float passed_length = 0.0f;  ///< from the last vertex to the last of them
  C3f expected{0.0f};          ///< what the sample is expected to see, W/(m2 sr); black: not known (I12)
};

/// Lobes with less density than this, per steradian, count as broad: what they gather is blurred. Diffuse ones
/// have at most 1 / pi.
inline constexpr float broad_lobe_pdf_w = 1.0f;

/// Adds what a path finds that escapes along `ray`, its edge number `edges` (I2).
inline void escape(const Scene& scene, const PathLimits& limits, PathSample& sample, const Carried& carried,
                   const Ray& ray, int edges) {
  const C3f sky = scene.environment().radiance(ray.direction);
  if (is_black(sky)) return;
  const float weight = carried.last_was_specular
                           ? 1.0f
                           : power_heuristic(carried.last_pdf_w, scene.lights().escaped_pdf_w(
                                                                     carried.last_receiver, ray.direction));
  sample.seen.radiance += clamped(carried.throughput * sky * weight, edges - carried.passed, limits);
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
        ray_(ray),
        edges_(edges - carried.passed),
        distance_(carried.passed_length + hit.t),
        point_(scene.surface_point(ray, hit)),
        bsdf_(&scene.resolve(point_, ray.direction, resolved_, [&sample] { return sample.sampler.next_1d(); })),
        wo_(point_.shading.to_local(-ray.direction)) {}

  /// Adds the light met here (I2). False: the path has all the edges that it may have.
  bool arrive() {
    const C3f emitted = scene_.emitted_radiance(point_);
    const bool hidden = limits_.hide_emitters && edges_ == 1 && !is_black(emitted);
    if (edges_ == 1) sample_.seen.alpha = hidden || is_hole() ? 0.0f : 1.0f;
    if (!is_black(emitted) && !hidden)
      sample_.seen.radiance += clamped(carried_.throughput * emitted * emission_weight(), edges_, limits_);
    return limits_.max_depth < 0 || edges_ < limits_.max_depth || is_hole();
  }

  /// Adds radiance that leaves the vertex along the path, and is not light met here.
  void add(const C3f& radiance) {
    sample_.seen.radiance += clamped(carried_.throughput * radiance, edges_ + 1, limits_);
  }

  /// Samples the lights; what they send along the path is added when the shadow ray has been cast. REQUIRES:
  /// the surface is not purely specular.
  void sample_lights() { sample_lights(ScatteredDirections(*bsdf_, wo_)); }
  /// The same where leave() draws from these directions.
  template <class Directions>
  void sample_lights(const Directions& directions) {
    if (scene_.lights().empty()) return;
    connection_ = sample_direct_light(scene_, point_, *bsdf_, wo_, directions, sample_.sampler);
    if (connection_)
      connection_->radiance = clamped(connection_->radiance * carried_.throughput, edges_ + 1, limits_);
  }

  /// Draws the next direction, and plays Russian roulette when the path is long (I4). False: the path ends.
  bool leave() { return leave(ScatteredDirections(*bsdf_, wo_)) && plays_roulette(); }
  /// Draws the next direction from these. False: the path ends.
  template <class Directions>
  bool leave(const Directions& directions) {
    const std::optional<BsdfSample> drawn = directions.sample(sample_.sampler.next_2d());
    if (!drawn) return false;
    const V3f direction = point_.shading.to_world(drawn->wi);
    const float reached = agreement_of_normals(point_, direction, drawn->wi.z);
    if (reached == 0.0f) return false;
    carried_.throughput *= drawn->weight * reached;
    carried_.relative_ior *= drawn->eta;
    carried_.last_pdf_w = drawn->pdf_w;
    carried_.last_was_specular = drawn->is_specular;
    carried_.passed_length = 0.0f;
    if (!drawn->is_specular) {
      carried_.gathers = drawn->pdf_w < broad_lobe_pdf_w;
      carried_.last_receiver = receiver_at(point_, *bsdf_);
    }
    next_ray_ = {spawn_position(point_, direction), direction};
    return true;
  }
  /// Russian roulette when the path is long (I4). False: the path ends.
  bool plays_roulette() {
    if (!is_long()) return true;
    const float probability = survival();
    if (sample_.sampler.next_1d() >= probability) return false;
    scale(1.0f / probability);
    return true;
  }
  /// Whether it is subject to roulette.
  [[nodiscard]] bool is_long() const { return edges_ >= limits_.rr_depth; }
  /// The probability with which it survives roulette. The square of the index of refraction undoes the
  /// compression of radiance inside glass: it is no loss of importance.
  [[nodiscard]] float survival() const {
    const float ior = carried_.relative_ior;
    return std::min(max_component(carried_.throughput) * ior * ior / least_share, 0.95f);
  }
  /// Of what the path will add.
  void scale(float factor) { carried_.throughput *= factor; }

  /// There is nothing here but a mask's hole: light passes straight through.
  [[nodiscard]] bool is_hole() const { return std::holds_alternative<Null>(*bsdf_); }
  /// Goes on in the same direction, as if there were no surface.
  void pass() {
    ++carried_.passed;
    carried_.passed_length = distance_;
    next_ray_ = {spawn_position(point_, ray_.direction), ray_.direction};
  }

  [[nodiscard]] const Bsdf& bsdf() const { return *bsdf_; }
  [[nodiscard]] const SurfacePoint& point() const { return point_; }
  /// Towards where the path came from, local, unit.
  [[nodiscard]] const V3f& wo() const { return wo_; }
  [[nodiscard]] const C3f& throughput() const { return carried_.throughput; }
  [[nodiscard]] Sampler& sampler() { return sample_.sampler; }
  /// What the sample is expected to see, W/(m2 sr): kept for the integrator, black at first.
  [[nodiscard]] C3f& expected() { return carried_.expected; }
  /// Length of the edge that led to the present vertex.
  [[nodiscard]] float distance() const { return distance_; }
  /// Whether what is seen here is blurred by the lobe that led here, with or without mirrors and glass in
  /// between.
  [[nodiscard]] bool gathers() const { return carried_.gathers; }
  /// The light sampled at this vertex, if any.
  [[nodiscard]] const std::optional<Connection>& connection() const { return connection_; }
  /// The next edge. REQUIRES: leave() was true, or pass() was called.
  [[nodiscard]] const Ray& next_ray() const { return next_ray_; }

 private:
  // All of the light where the last vertex could not have sampled it (the camera, a specular vertex), else the
  // share of the scattered ray (I3).
  [[nodiscard]] float emission_weight() const {
    if (carried_.last_was_specular) return 1.0f;
    const float light_pdf_w = scene_.lights().pdf_w(carried_.last_receiver, ray_.direction, distance_, point_);
    return power_heuristic(carried_.last_pdf_w, light_pdf_w);
  }

  // Paths play that carry less than this share of their importance, and carry it again if they survive. Playing
  // already below 1 saves few rays for much variance (I4).
  static constexpr float least_share = 0.25f;

  const Scene& scene_;
  const PathLimits& limits_;
  PathSample& sample_;
  Carried& carried_;
  const Ray& ray_;  // that led here
  int edges_;
  float distance_;
  SurfacePoint point_;
  Bsdf resolved_;  // the model, where it varies over the surface
  const Bsdf* bsdf_;
  V3f wo_;  // towards where the path came from, local
  std::optional<Connection> connection_;
  Ray next_ray_;
};

}  // namespace twopass
