#include "radiosity/weights_from_afar.h"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "radiosity/specular_path.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/core/sampler.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

constexpr std::uint32_t sixteenths = 16;
constexpr std::uint32_t visits_of_a_cell = 128, least_visits = 32;

// How often walks come to a sixteenth, and one of the places. A sum of integers and a least, so the order of
// threads does not matter.
class Visits {
 public:
  /// Of all visits the place is that of the one with the least key.
  void add(std::uint64_t key, float u, float v) {
    count_.fetch_add(1, std::memory_order_relaxed);
    const auto [a, b] = ElementMesh::Weights::packed(u, v);
    const std::uint64_t mine = (key & ~std::uint64_t{0xffff}) | std::uint64_t{a} << 8 | b;
    std::uint64_t least = least_.load(std::memory_order_relaxed);
    while (mine < least && !least_.compare_exchange_weak(least, mine, std::memory_order_relaxed)) {
    }
  }
  [[nodiscard]] std::uint32_t count() const { return count_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::array<std::uint8_t, 2> place() const {
    const std::uint64_t least = least_.load(std::memory_order_relaxed);
    return {static_cast<std::uint8_t>(least >> 8), static_cast<std::uint8_t>(least)};
  }

 private:
  std::atomic<std::uint32_t> count_{0};
  std::atomic<std::uint64_t> least_{~std::uint64_t{0}};  // key, and the place in its last two bytes
};

// A walk of so many edges from where the ray comes to. What the ray itself meets does not count: the camera
// reads no elements.
void walk(const Scene& scene, const ElementMesh& mesh, Ray ray, std::uint32_t seed, std::uint32_t number,
          std::uint32_t edges, std::vector<Visits>& visits, std::uint64_t& rays) {
  for (std::uint32_t edge = 0; edge <= edges; ++edge) {
    const Hit hit = scene.caster().intersect(ray);
    ++rays;
    if (hit.escaped()) return;
    SurfacePoint point = scene.surface_point(ray, hit);
    Sampler sampler(seed, number, edge);
    const bool is_specular = scene.side(point).scatters_without_diffusing();
    if (is_specular) {
      const SpecularPathEnd end = follow_specular(scene, ray, point, Carried::power, sampler);
      rays += end.rays;
      if (end.escaped) return;
      point = end.point;
    }
    const ElementMesh::Location at = mesh.locate(point);
    if (edge > 0 && at.element != no_index && !mesh.is_cluster(at.element) &&
        (is_specular || hit.t >= contact_elements * mesh.size(at.element))) {
      const ElementMesh::Sixteenth part = ElementMesh::sixteenth_at(at);
      visits[std::size_t{at.element} * sixteenths + part.number].add(hash_words(number, edge), part.u, part.v);
    }
    ray.direction = Frame(point.geometric_normal).to_world(square_to_cosine_hemisphere(sampler.next_2d()));
    ray.origin = spawn_position(point, ray.direction);
  }
}

}  // namespace

std::vector<ElementMesh::Weights> weights_from_afar(const Scene& scene, const ElementMesh& mesh,
                                                    std::span<const Ray> view, std::uint32_t seed,
                                                    std::uint64_t& rays) {
  const std::size_t cells = mesh.count() - mesh.cluster_count();
  const auto edges = static_cast<std::uint32_t>(visits_of_a_cell * cells / view.size() + 1);
  std::vector<Visits> visits(cells * sixteenths);
  std::atomic<std::uint64_t> rays_cast{0};
  parallel_for(view.size(), 64, [&](std::size_t begin, std::size_t end) {
    throw_if_interrupted();
    std::uint64_t own_rays = 0;
    for (std::size_t k = begin; k < end; ++k)
      walk(scene, mesh, view[k], seed, static_cast<std::uint32_t>(k), edges, visits, own_rays);
    rays_cast += own_rays;
  });
  rays += rays_cast;
  std::vector<ElementMesh::Weights> weights(cells, ElementMesh::Weights{});
  for (std::size_t i = 0; i < cells; ++i) {
    std::array<std::uint32_t, sixteenths> here;
    for (std::uint32_t k = 0; k < sixteenths; ++k) here[k] = visits[i * sixteenths + k].count();
    if (std::accumulate(here.begin(), here.end(), 0u) < least_visits) continue;
    // In bytes, rounded up: none that is seen is lost.
    const std::uint32_t divisor = *std::max_element(here.begin(), here.end()) / 255 + 1;
    for (std::uint32_t k = 0; k < sixteenths; ++k) {
      weights[i].count[k] = static_cast<std::uint8_t>((here[k] + divisor - 1) / divisor);
      if (here[k] > 0) weights[i].place[k] = visits[i * sixteenths + k].place();
    }
  }
  return weights;
}

}  // namespace twopass
