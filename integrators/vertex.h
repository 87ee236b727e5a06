// A path at one of its vertices: the light that it runs into, and where it may go from there.
#pragma once

#include "integrators/clamp.h"
#include "integrators/direct_light.h"
#include "integrators/guided_directions.h"
#include "integrators/sample_layers.h"
#include "materials/lobes.h"

namespace twopass {

/// What a path carries from vertex to vertex. It remembers how its last direction was drawn, which is all that
/// is needed to weigh light that it meets by chance against light that was sampled on purpose.
struct Carried {
  C3f throughput{1.0f};
  float relative_ior = 1.0f;
  float last_pdf_w = 0.0f;
  Receiver last_receiver;  ///< the vertex that the ray left; set once last_was_specular is false
  bool last_was_specular = true;
  bool has_direct = false;  ///< the last vertex has its direct light; meaningful where not last_was_specular
  /// A direction was drawn from a broad lobe before: what the path sees is blurred, over sharp lobes, too.
  bool gathers = false;
  int scatterings = 0;         ///< other than at mirrors and glass
  int passed = 0;              ///< surfaces that it went straight through; no edge ends there
  float passed_length = 0.0f;  ///< from the last vertex to the last of them
  /// Since the last surface that diffuses, the path has gone over others alone; and the part of it for which
  /// light that lamps send that way has not been added there (I19).
  bool over_specular = false;
  C3f uncharted{1.0f};
  C3f expected{0.0f};  ///< what the sample is expected to see, W/(m2 sr); black: not known (I12)
};

/// Lobes with less density than this, per steradian, count as broad: what they gather is blurred. Diffuse ones
/// have at most 1 / pi.
inline constexpr float broad_lobe_pdf_w = 1.0f;

/// Russian roulette (I4) of a path that carries `share` of its importance. Paths play that carry less than a
/// quarter, and carry it again if they survive: playing already below 1 saves few rays for much variance.
/// Others all but survive: where nothing is absorbed they end after 10,000 edges or so. To end them much
/// earlier would leave the light of nearly white rooms to rare paths that are as bright as they are rare.
inline float survival_probability(float share) {
  constexpr float least_share = 0.25f, most = 1.0f - 1e-4f;
  return std::min(share * (1.0f / least_share), most);
}

/// What a path does at a vertex, after it has met the light there.
enum class Step : std::uint8_t {
  end,
  light,             ///< samples the lights, in full, and ends. REQUIRES: the surface is not purely specular
  scatter,           ///< goes on in a direction drawn from the scattering model
  light_and_scatter  ///< samples the lights and goes on. REQUIRES: the surface is not purely specular
};

/// Adds to the layers light that the path's edge number `edges` meets; `seen`: its class if it is seen
/// directly.
inline void add_met(SampleLayers& layers, const C3f& radiance, int edges, LightClass seen,
                    std::uint32_t light) {
  if (edges == 1)
    layers.add(seen, radiance, light);
  else
    layers.add_scattered(radiance, layers.scatter, edges == 2, light);
}

/// Adds what a path finds that escapes along `ray`, its edge number `edges` (I2).
inline void escape(const Scene& scene, const PathLimits& limits, PathSample& sample, const Carried& carried,
                   const Ray& ray, int edges) {
  const C3f sky = scene.environment().radiance(ray.direction);
  if (is_black(sky)) return;
  const float weight = carried.last_was_specular ? 1.0f
                       : carried.has_direct
                           ? 0.0f
                           : power_heuristic(carried.last_pdf_w, scene.lights().escaped_pdf_w(
                                                                     carried.last_receiver, ray.direction));
  const C3f radiance = clamped(carried.throughput * sky * weight, edges - carried.passed, limits);
  sample.seen.radiance += radiance;
  if (sample.layers) [[unlikely]]
    add_met(*sample.layers, radiance, edges - carried.passed, LightClass::background,
            scene.lights().environment_number());
}

/// A path at the surface where its edge number `edges` ends: the steps that all integrators share.
class Vertex {
 public:
  Vertex() = default;
  /// REQUIRES: !hit.escaped(); everything but ray and hit outlives the vertex.
  Vertex(const Scene& scene, const PathLimits& limits, PathSample& sample, Carried& carried, const Ray& ray,
         const Hit& hit, int edges)
      : scene_(&scene),
        limits_(&limits),
        sample_(&sample),
        carried_(&carried),
        direction_(ray.direction),
        edges_(edges - carried.passed),
        distance_(carried.passed_length + hit.t),
        point_(scene.surface_point(ray, hit)),
        bsdf_(&resolve()) {}

  /// Adds the light met here (I2). False: the path has all the edges that it may have.
  bool arrive() {
    C3f emitted = scene_->emitted_radiance(point_);
    if (carried_->over_specular) emitted *= carried_->uncharted;
    const bool hidden = limits_->hide_emitters && edges_ == 1 && !is_black(emitted);
    if (edges_ == 1) {
      sample_->seen.alpha = hidden || is_hole() ? 0.0f : 1.0f;
      if (sample_->layers) [[unlikely]]
        see_first(hidden);
    }
    if (!is_black(emitted) && !hidden) {
      const C3f radiance = clamped(carried_->throughput * emitted * emission_weight(), edges_, *limits_);
      sample_->seen.radiance += radiance;
      if (sample_->layers) [[unlikely]]
        add_met(*sample_->layers, radiance, edges_, LightClass::emission, point_.shape);
    }
    return limits_->max_depth < 0 || edges_ < limits_->max_depth || is_hole();
  }

  /// There is nothing here but a mask's hole: light passes straight through.
  [[nodiscard]] bool is_hole() const { return std::holds_alternative<Null>(*bsdf_); }
  /// Goes on in the same direction, as if there were no surface: the next ray.
  Ray pass() {
    ++carried_->passed;
    carried_->passed_length = distance_;
    return {spawn_position(point_, direction_), direction_};
  }

  [[nodiscard]] bool has_layers() const { return sample_->layers != nullptr; }
  /// Adds radiance that diffuse reflection sends along the path from here, by what was looked up of the
  /// solution. `irradiance`: what it reflects, in proportion.
  void add(const C3f& radiance, const Irradiance& irradiance, LookUp look_up) {
    const C3f added = clamped(carried_->throughput * radiance, edges_ + 1, *limits_);
    sample_->seen.radiance += added;
    if (sample_->layers) [[unlikely]]
      add_to_layers(added, irradiance, look_up);
  }

  /// Adds direct light that is known without sampling, W/m2, to a surface of Lambert's model. `light`: where it
  /// comes from, see Lights.
  void add_direct(const C3f& irradiance, std::uint32_t light) {
    const C3f added = clamped(carried_->throughput * diffuse_reflectance(*bsdf_) * irradiance * (1.0f / pi_f),
                              edges_ + 1, *limits_);
    sample_->seen.radiance += added;
    if (sample_->layers) [[unlikely]]
      sample_->layers->add_scattered(
          added, edges_ > 1 ? sample_->layers->scatter : FirstScatter{C3f(1.0f), false}, edges_ == 1, light);
  }
  /// Adds what diffuse reflection sends along the path of light that arrives over surfaces that do not diffuse.
  /// REQUIRES: there are no clamps.
  void add_caustic(const C3f& radiance) { sample_->seen.radiance += carried_->throughput * radiance; }
  /// Part of the same, from one light, for the layers. REQUIRES: has_layers().
  void add_caustic_to_layers(const C3f& radiance, std::uint32_t light) {
    SampleLayers& layers = *sample_->layers;
    layers.add_scattered(carried_->throughput * radiance,
                         edges_ > 1 ? layers.scatter : FirstScatter{C3f(1.0f), false}, false, light);
  }
  /// What lamps send here over surfaces that do not diffuse has been added, for what diffuse reflection makes
  /// of it (I19): the path finds the rest of it.
  void set_has_caustics() { caustics_ = Caustics::known; }
  /// The surface does not diffuse: what the last one that does has of it, the path does not find again.
  void pass_on_caustics() { caustics_ = Caustics::passed; }
  /// All direct light of the vertex has been added: no ray from here may find it again.
  void set_has_direct() { has_direct_ = true; }

  /// Draws the numbers that the step takes. REQUIRES: step is not `end`.
  void draw(Step step) {
    goes_on_ = step != Step::light;
    samples_lights_ = step != Step::scatter && !scene_->lights().empty();
    if (samples_lights_) u_light_ = sample_->sampler.next_2d();
    if (goes_on_) u_direction_ = sample_->sampler.next_2d();
  }
  /// Asks for what leave() will read of the guide, so that it is at hand by then.
  void aim() {
    if (goes_on_ && share_ > 0.0f) guide_row_ = guide_.row_of(u_direction_.y);
  }
  [[nodiscard]] bool goes_on() const { return goes_on_; }
  [[nodiscard]] bool samples_lights() const { return samples_lights_; }
  /// Where the path came from, in the shading frame.
  [[nodiscard]] V3f wo() const { return point_.shading.to_local(-direction_); }
  /// The light sampled here. REQUIRES: samples_lights().
  [[nodiscard]] Incident sample_lights() const { return sample_incident(*scene_, point_, *bsdf_, u_light_); }
  /// What the model says of the pair of wo() and `wi`.
  [[nodiscard]] BsdfValue evaluate(const V3f& wi) const {
    return visit_model(*bsdf_, [&](const auto& model) {
      // Inside, because Lambert's model does not look at where the path came from.
      return twopass::evaluate(model, wo(), wi);
    });
  }
  /// The light sample with what it sends along the path. `at`: evaluate(incident.wi).
  /// REQUIRES: incident.reached > 0.
  [[nodiscard]] Connection connect(const Incident& incident, const BsdfValue& at) const {
    Connection connection =
        connection_to(point_, incident, at, goes_on_, share_ > 0.0f ? &guide_ : nullptr, share_);
    if (whole_) connection.radiance += in_full(incident, eval_diffuse(*whole_, wo(), incident.wi));
    if (caustics_ == Caustics::passed && connection.light < scene_->shapes().size())
      connection.radiance *= carried_->uncharted;
    connection.radiance = clamped(connection.radiance * carried_->throughput, edges_ + 1, *limits_);
    return connection;
  }

  /// How the path's first surface sends on light that arrives here from the unit direction, if that is sent
  /// along the path. REQUIRES: the sample has layers.
  [[nodiscard]] FirstScatter first_scatter_of(const V3f& direction) const {
    if (edges_ > 1) return sample_->layers->scatter;
    const V3f wi = point_.shading.to_local(direction);
    return {diffuse_share(whole_ ? *whole_ : *bsdf_, wo(), wi), wi.z < 0.0f};
  }
  /// Whether light that arrives here straight from a light is direct light of the picture.
  [[nodiscard]] bool is_first() const { return edges_ == 1; }

  /// Whether the next direction is the model's alone: sample(bsdf(), wo(), u_direction()).
  [[nodiscard]] bool follows_model() const { return goes_on_ && !(share_ > 0.0f); }
  [[nodiscard]] const V2f& u_direction() const { return u_direction_; }
  /// Draws the next direction. REQUIRES: aim().
  [[nodiscard]] std::optional<BsdfSample> scatter() const {
    if (share_ > 0.0f)
      return GuidedDirections(*bsdf_, wo(), point_.shading, guide_, share_).sample(u_direction_, guide_row_);
    return visit_model(*bsdf_, [this](const auto& model) { return model.sample(wo(), u_direction_); });
  }
  /// Takes the next direction, and plays Russian roulette when the path is long (I4). False: the path ends.
  bool leave(const std::optional<BsdfSample>& drawn, Ray& next) {
    if (!drawn) return false;
    const V3f direction = point_.shading.to_world(drawn->wi);
    const float reached = agreement_of_normals(point_, direction, drawn->wi.z);
    if (reached == 0.0f) return false;
    if (sample_->layers && edges_ == 1) [[unlikely]]
      sample_->layers->scatter = drawn->is_specular || lacks_diffuse_
                                     ? FirstScatter{C3f(0.0f), drawn->wi.z < 0.0f}
                                     : first_scatter_of(direction);
    Carried& carried = *carried_;
    carried.throughput *= drawn->weight * reached;
    if (lacks_diffuse_ && !survives(survival_probability(max_component(drawn->weight) * reached))) return false;
    if (caustics_ == Caustics::known) {
      carried.over_specular = false;
      carried.uncharted = drawn->is_specular || lacks_diffuse_ ? C3f(1.0f) : glossy_share(*drawn);
    }
    carried.over_specular = carried.over_specular || caustics_ == Caustics::passed;
    carried.relative_ior *= drawn->eta;
    carried.last_pdf_w = drawn->pdf_w;
    carried.last_was_specular = drawn->is_specular;
    carried.passed_length = 0.0f;
    if (sample_->cone.is_open())
      sample_->cone = sample_->cone.scattered(distance_, drawn->pdf_w, drawn->is_specular);
    if (!drawn->is_specular) {
      carried.has_direct = has_direct_;
      carried.gathers = carried.gathers || drawn->pdf_w < broad_lobe_pdf_w;
      ++carried.scatterings;
      carried.last_receiver = receiver_at(point_, *bsdf_);
    }
    next.origin = spawn_position(point_, direction);
    next.direction = direction;
    return has_settled_ || !is_long() || survives(survival());
  }

  /// Has leave() draw from a guide, with the probability that suits the surface (I11); an empty one: not at
  /// all.
  void guide_by(const Guide::Lobe& guide) {
    guide_ = guide;
    share_ = share_of(guide);
  }
  /// Whether the path is subject to roulette, and the probability with which it would survive. The square of
  /// the index of refraction undoes the compression of radiance inside glass: it is no loss of importance.
  [[nodiscard]] bool is_long() const { return edges_ >= limits_->rr_depth; }
  [[nodiscard]] float survival() const {
    const float ior = carried_->relative_ior;
    return survival_probability(max_component(carried_->throughput) * ior * ior);
  }
  /// What the surface reflects diffusely along the path of light that comes evenly from all around, over that
  /// light's radiance: an estimate where there is no closed form. REQUIRES: not purely specular.
  [[nodiscard]] C3f diffuse_albedo() {
    if (const auto albedo = twopass::diffuse_albedo(*bsdf_, wo())) return *albedo;
    const V3f wi = square_to_cosine_hemisphere(sample_->sampler.next_2d());
    const float pdf_w = cosine_hemisphere_pdf_w(wi.z);
    if (!(pdf_w > 0.0f)) return C3f(0.0f);
    return eval_diffuse(*bsdf_, wo(), wi) * (1.0f / pdf_w);
  }
  /// What diffuse reflection sends along the path has been added, of all light or of all but what lamps send
  /// here: the path goes on by the other lobes alone. Few rays go where little is left (I4).
  void leave_out_diffuse() {
    rest_ = without_diffuse(*bsdf_);
    bsdf_ = &rest_;
    lacks_diffuse_ = true;
  }
  void leave_out_indirect_diffuse() {
    whole_ = bsdf_;
    leave_out_diffuse();
  }

  /// Scales what the path will add from here on; the integrator has played roulette, leave() will not.
  void settle(float scale) {
    carried_->throughput *= scale;
    has_settled_ = true;
  }

  /// The element that an integrator's look_ahead() has found here; no_index: none, or not asked for.
  void set_place(const ElementMesh::Location& place) { place_ = place; }
  [[nodiscard]] const ElementMesh::Location& place() const { return place_; }
  [[nodiscard]] std::uint32_t element() const { return place_.element; }

  [[nodiscard]] const Bsdf& bsdf() const { return *bsdf_; }
  [[nodiscard]] const SurfacePoint& point() const { return point_; }
  [[nodiscard]] const C3f& throughput() const { return carried_->throughput; }
  [[nodiscard]] Sampler& sampler() { return sample_->sampler; }
  [[nodiscard]] const PathSample& sample() const { return *sample_; }
  /// What the sample is expected to see, W/(m2 sr): kept for the integrator, black at first.
  [[nodiscard]] C3f& expected() { return carried_->expected; }
  /// Length of the edge that led to the vertex.
  [[nodiscard]] float distance() const { return distance_; }
  /// Whether what is seen here is blurred by the lobe that led here, with or without mirrors and glass in
  /// between.
  [[nodiscard]] bool gathers() const { return carried_->gathers; }
  /// How often the path has been scattered other than by mirrors and glass.
  [[nodiscard]] int scatterings() const { return carried_->scatterings; }

 private:
  void see_first(bool hidden) {
    FirstSurface& first = sample_->layers->first;
    first.is_there = !hidden && !is_hole();
    if (!first.is_there) return;
    first.point = point_;
    first.distance = distance_;
    first.albedo = albedo(*bsdf_);
    first.diffuse_albedo = diffuse_reflectance(*bsdf_);
  }
  void add_to_layers(const C3f& radiance, const Irradiance& irradiance, LookUp look_up) {
    SampleLayers& layers = *sample_->layers;
    layers.looked_up = layers.looked_up || (look_up == LookUp::field && carried_->scatterings == 0);
    layers.gathered = layers.gathered || (look_up == LookUp::element && carried_->scatterings == 1);
    const C3f total = irradiance.total();
    C3f direct(0.0f);
    for (int c = 0; c < 3; ++c)
      if (total[c] > 0.0f) direct[c] = radiance[c] * (irradiance.direct[c] / total[c]);
    const FirstScatter by = edges_ > 1 ? layers.scatter : FirstScatter{C3f(1.0f), false};
    layers.add_looked_up(direct, radiance - direct, by, edges_ == 1, point_, look_up);
  }

  const Bsdf& resolve() {
    if (sample_->cone.is_open()) point_.beam_width = sample_->cone.width_at(distance_);
    return scene_->resolve(point_, direction_, resolved_, [this] { return sample_->sampler.next_1d(); });
  }

  // All of the light where the last vertex could not have sampled it (the camera, a specular vertex), else the
  // share of the scattered ray (I3).
  [[nodiscard]] float emission_weight() const {
    if (carried_->last_was_specular) return 1.0f;
    if (carried_->has_direct) return 0.0f;
    const float light_pdf_w = scene_->lights().pdf_w(carried_->last_receiver, direction_, distance_, point_);
    return power_heuristic(carried_->last_pdf_w, light_pdf_w);
  }

  // Under one flat normal the cosine that the guide knows is all there is.
  [[nodiscard]] float share_of(const Guide::Lobe& guide) const {
    constexpr float share_of_mixed = 0.5f;
    if (guide.empty()) return 0.0f;
    if (std::holds_alternative<Diffuse>(*bsdf_) && point_.shading.n == point_.geometric_normal) return 1.0f;
    return is_black(diffuse_reflectance(*bsdf_)) ? 0.0f : share_of_mixed;
  }

  // Of what the surface sends along the path from the direction drawn, the part that is not reflected
  // diffusely.
  [[nodiscard]] C3f glossy_share(const BsdfSample& drawn) const {
    C3f share(0.0f);
    if (std::holds_alternative<Diffuse>(*bsdf_)) return share;
    const C3f all = drawn.weight * drawn.pdf_w, diffuse = eval_diffuse(*bsdf_, wo(), drawn.wi);
    for (int c = 0; c < 3; ++c)
      if (all[c] > 0.0f) share[c] = std::clamp(1.0f - diffuse[c] / all[c], 0.0f, 1.0f);
    return share;
  }

  bool survives(float probability) {
    if (sample_->sampler.next_1d() >= probability) return false;
    carried_->throughput *= 1.0f / probability;
    return true;
  }

  enum class Caustics : std::uint8_t { unknown, known, passed };

  const Scene* scene_;
  const PathLimits* limits_;
  PathSample* sample_;
  Carried* carried_;
  V3f direction_;  // of the edge that led here
  int edges_;
  float distance_;
  bool samples_lights_, goes_on_, has_settled_ = false, has_direct_ = false, lacks_diffuse_ = false;
  Caustics caustics_ = Caustics::unknown;
  float share_ = 0.0f;  // of the guide
  Guide::Lobe guide_;
  int guide_row_ = 0;
  ElementMesh::Location place_{no_index, no_index, 0.0f, 0.0f};
  V2f u_light_, u_direction_;
  SurfacePoint point_;
  Bsdf resolved_;  // the model, where it varies over the surface; before bsdf_, which may point to it
  const Bsdf* bsdf_;
  const Bsdf* whole_ =
      nullptr;  // where bsdf_ has no diffuse lobes, the model that says how lamps are reflected
  Bsdf rest_;   // without diffuse lobes
};

}  // namespace twopass
