// Paths in lock step: a bundle of them moves edge by edge, so that its rays are cast in packets (I6), and
// vertex by vertex in stages (I10).
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "integrators/vertex.h"
#include "materials/scattering_block.h"

namespace twopass {

/// The driver of a bundle of paths. An integrator is what it does at a vertex: `at_vertex(vertex)` may add
/// radiance, and says which step comes next; `at_vertex.look_ahead(vertex)`, if there is one, is called for a
/// block of vertices before that, to ask for what will be read there (I10). Light sampling is linear, so no
/// path waits for its shadow ray: what the ray would carry is kept beside it, and is added or not.
class Bundle {
 public:
  /// REQUIRES: at most bundle_size samples, which outlive the bundle.
  Bundle(const Scene& scene, const PathLimits& limits, std::span<PathSample> samples)
      : scene_(scene), limits_(limits), samples_(samples) {}

  template <class AtVertex>
  void trace(RayCounts& counts, const AtVertex& at_vertex) {
    for (live_ = 0; live_ < samples_.size(); ++live_) {
      samples_[live_].seen = {};
      if (samples_[live_].layers) [[unlikely]]
        start_layers(*samples_[live_].layers);
      rays_[live_] = samples_[live_].ray;
      lanes_[live_] = static_cast<std::uint8_t>(live_);
    }
    for (int edges = 1; live_ > 0; ++edges) {
      counts.rays += live_;
      scene_.caster().intersect({rays_.data(), live_}, hits_, kind_of_edge(edges));
      if (edges == 1) clip();
      const std::size_t arriving = live_;
      live_ = connected_ = 0;
      for (std::size_t begin = 0; begin < arriving; begin += block_size)
        move(begin, std::min(begin + block_size, arriving), edges, counts, at_vertex);
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

  // Takes the paths [begin, end) through the vertices at the ends of their edges. Those that go on move up in
  // the arrays, where they never overtake those that are still to come. Each stage is a short loop over all of
  // them, so that the processor works on several at a time instead of waiting for every number of one (I10).
  template <class AtVertex>
  void move(std::size_t begin, std::size_t end, int edges, RayCounts& counts, const AtVertex& at_vertex) {
    std::size_t count = arrive(begin, end, edges, counts);
    const std::size_t arrived = std::exchange(count, 0);
    if constexpr (requires { at_vertex.look_ahead(vertices_[0]); })
      for (std::size_t k = 0; k < arrived; ++k) at_vertex.look_ahead(vertices_[k]);
    for (std::size_t k = 0; k < arrived; ++k) {
      const Step step = at_vertex(vertices_[k]);
      if (step == Step::end) continue;
      vertices_[k].draw(step);
      leaving_[count++] = static_cast<std::uint8_t>(k);
    }
    const auto leaving = std::span(leaving_).first(count);
    for (const std::uint8_t k : leaving) vertices_[k].aim();
    scattering_.reset(
        leaving, [this](std::size_t k) -> const Bsdf& { return vertices_[k].bsdf(); },
        [this](std::size_t k) { return vertices_[k].wo(); });
    connect(leaving);
    leave(leaving);
  }

  // The number of paths that have arrived at vertices where they may go on.
  std::size_t arrive(std::size_t begin, std::size_t end, int edges, RayCounts& counts) {
    scene_.prefetch({hits_.data() + begin, end - begin});
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint8_t lane = lanes_[i];
      if (hits_[i].escaped()) {
        ++counts.escaped_rays;
        escape(scene_, limits_, samples_[lane], carried_[lane], rays_[i], edges);
        continue;
      }
      Vertex& vertex = *std::construct_at(&vertices_[count], scene_, limits_, samples_[lane], carried_[lane],
                                          rays_[i], hits_[i], edges);
      if (!vertex.arrive()) continue;
      if (vertex.is_hole()) {
        rays_[live_] = vertex.pass();
        lanes_[live_++] = lane;
        continue;
      }
      vertex_lanes_[count++] = lane;
    }
    return count;
  }

  void start_layers(SampleLayers& layers) {
    layers.restart();
    layers_.resize(bundle_size);
  }

  // Vertices whose models have lanes wait for the others.
  void connect(std::span<const std::uint8_t> leaving) {
    std::size_t waiting = 0;
    for (const std::uint8_t k : leaving) {
      if (!vertices_[k].samples_lights()) continue;
      const Incident incident = vertices_[k].sample_lights();
      if (incident.reached == 0.0f) continue;
      if (scattering_.has(k)) {
        scattering_.set_wi(k, incident.wi);
        incident_[k] = incident;
        waiting_[waiting++] = k;
      } else {
        connect(k, incident, vertices_[k].evaluate(incident.wi));
      }
    }
    if (waiting == 0) return;
    scattering_.evaluate();
    for (const std::uint8_t k : std::span(waiting_).first(waiting))
      connect(k, incident_[k], scattering_.value(k));
  }
  void connect(std::uint8_t k, const Incident& incident, const BsdfValue& at) {
    const Vertex& vertex = vertices_[k];
    const std::uint8_t lane = vertex_lanes_[k];
    const Connection connection = vertex.connect(incident, at);
    if (is_black(connection.radiance)) return;
    if (samples_[lane].layers) [[unlikely]]
      layers_[connected_] = {vertex.first_scatter_of(unit(connection.segment.to - connection.segment.from)),
                             vertex.is_first(), connection.light};
    segments_[connected_] = connection.segment;
    light_[connected_++] = {connection.radiance, lane};
  }

  void leave(std::span<const std::uint8_t> leaving) {
    if (!scattering_.empty()) {
      for (const std::uint8_t k : leaving)
        if (vertices_[k].follows_model()) scattering_.set_u(k, vertices_[k].u_direction());
      scattering_.sample();
    }
    for (const std::uint8_t k : leaving) {
      Vertex& vertex = vertices_[k];
      if (!vertex.goes_on()) continue;
      const bool is_drawn = vertex.follows_model() && scattering_.has(k);
      if (vertex.leave(is_drawn ? scattering_.drawn(k) : vertex.scatter(), rays_[live_]))
        lanes_[live_++] = vertex_lanes_[k];
    }
  }

  void add_unoccluded() {
    if (scene_.has_see_through()) {
      for (std::size_t i = 0; i < connected_; ++i)
        add_light(i, light_[i].radiance * scene_.transmittance(segments_[i]));
      return;
    }
    scene_.caster().occluded({segments_.data(), connected_}, occluded_);
    for (std::size_t i = 0; i < connected_; ++i)
      if (!occluded_[i]) add_light(i, light_[i].radiance);
  }

  void add_light(std::size_t i, const C3f& radiance) {
    PathSample& sample = samples_[light_[i].lane];
    sample.seen.radiance += radiance;
    if (sample.layers) [[unlikely]]
      sample.layers->add_scattered(radiance, layers_[i].scatter, layers_[i].is_direct, layers_[i].light);
  }

  struct Light {
    C3f radiance;
    std::uint8_t lane;
  };
  // What the layers need to know of it.
  struct LightLayers {
    FirstScatter scatter;
    bool is_direct;
    std::uint32_t light;
  };

  const Scene& scene_;
  const PathLimits& limits_;
  std::span<PathSample> samples_;
  std::array<Carried, bundle_size> carried_;  // by lane, that is by sample
  // By path that is still alive.
  std::size_t live_ = 0;
  std::array<std::uint8_t, bundle_size> lanes_;
  std::array<Ray, bundle_size> rays_;
  std::array<Hit, bundle_size> hits_;
  // By vertex of the present block, which is small enough to stay in the nearest cache from one stage to the
  // next; which of them their paths leave.
  std::array<Vertex, block_size> vertices_;
  std::array<std::uint8_t, block_size> vertex_lanes_, leaving_, waiting_;
  std::array<Incident, block_size> incident_;
  ScatteringBlock scattering_;
  // By light sample of the present vertices.
  std::size_t connected_ = 0;
  std::array<Segment, bundle_size> segments_;
  std::array<Light, bundle_size> light_;
  std::vector<LightLayers> layers_;  // none where no sample has layers
  std::array<bool, bundle_size> occluded_;
};

/// Traces any number of samples, a bundle at a time.
template <class AtVertex>
void trace_bundles(const Scene& scene, const PathLimits& limits, std::span<PathSample> samples,
                   RayCounts& counts, const AtVertex& at_vertex) {
  while (!samples.empty()) {
    const std::size_t count = std::min(samples.size(), bundle_size);
    Bundle(scene, limits, samples.first(count)).trace(counts, at_vertex);
    samples = samples.subspan(count);
  }
}

}  // namespace twopass
