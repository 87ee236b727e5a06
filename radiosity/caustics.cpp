#include "radiosity/caustics.h"

#include <atomic>

#include "radiosity/specular_path.h"
#include "render/core/distribution.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

// An emitting side of a triangle, or of a piece of an analytic surface.
struct Source {
  Patch patch;
  C3f radiance;
};

struct Deposit {
  std::uint32_t element;
  C3f power;
};

void add_sources(std::vector<Source>& sources, const Shape& shape, Side side) {
  const C3f& radiance = shape.radiance[side];
  if (is_black(radiance)) return;
  for (std::uint32_t i = 0; i < piece_count(shape.geometry); ++i)
    sources.push_back({piece_patch(shape.geometry, i, side), radiance});
}

class Shooter {
 public:
  Shooter(const Scene& scene, const ElementMesh& mesh, std::size_t paths, std::uint32_t seed)
      : scene_(scene), mesh_(mesh), paths_(paths), seed_(seed) {
    for (const Shape& shape : scene.shapes())
      for (const Side side : {front, back}) add_sources(sources_, shape, side);
    std::vector<double> power;
    for (const Source& source : sources_) power.push_back(source.patch.area * mean_component(source.radiance));
    choice_ = DiscreteDistribution(power);
  }

  [[nodiscard]] bool empty() const { return choice_.empty(); }

  // Where particle k ends, if it has met a specular surface and then an element.
  [[nodiscard]] std::optional<Deposit> shoot(std::uint32_t k, std::uint64_t& rays) const {
    Sampler sampler(seed_, 0, k);
    const V2f u = sampler.next_2d();
    const auto choice = choice_.sample(u.x);
    const Source& source = sources_[choice.index];
    const ElementPoint start = source.patch.sample({choice.remapped, u.y});
    const V3f direction = Frame(V3f(start.normal)).to_world(square_to_cosine_hemisphere(sampler.next_2d()));
    const Ray ray{start.ray_position(), direction};
    const Hit hit = scene_.caster().intersect(ray);
    ++rays;
    if (hit.escaped()) return std::nullopt;
    const SurfacePoint point = scene_.surface_point(ray, hit);
    if (!scene_.side(point).scatters_without_diffusing()) return std::nullopt;
    const SpecularPathEnd end = follow_specular(scene_, ray, point, Carried::power, sampler);
    rays += end.rays;
    if (end.escaped || is_black(end.weight)) return std::nullopt;
    const std::uint32_t element = mesh_.find(end.point);
    if (element == no_index) return std::nullopt;
    const auto share =
        static_cast<float>(pi * source.patch.area / (choice.probability * static_cast<double>(paths_)));
    return Deposit{element, source.radiance * end.weight * share};
  }

 private:
  const Scene& scene_;
  const ElementMesh& mesh_;
  std::size_t paths_;
  std::uint32_t seed_;
  std::vector<Source> sources_;
  DiscreteDistribution choice_;
};

}  // namespace

std::vector<C3d> caustic_irradiance(const Scene& scene, const ElementMesh& mesh, std::size_t paths,
                                    std::uint32_t seed, std::uint64_t& rays) {
  std::vector<C3d> irradiance(mesh.count(), C3d(0.0));
  const Shooter shooter(scene, mesh, paths, seed);
  if (shooter.empty()) return irradiance;
  // Deposits are kept by piece of work and added up in its order: the same sums on any number of threads.
  constexpr std::size_t piece = 4096;
  std::vector<std::vector<Deposit>> deposits((paths + piece - 1) / piece);
  std::atomic<std::uint64_t> rays_cast{0};
  parallel_for(deposits.size(), 1, [&](std::size_t begin, std::size_t end) {
    throw_if_interrupted();
    std::uint64_t own_rays = 0;
    for (std::size_t p = begin; p < end; ++p)
      for (std::size_t k = p * piece; k < std::min(paths, (p + 1) * piece); ++k)
        if (const auto deposit = shooter.shoot(static_cast<std::uint32_t>(k), own_rays))
          deposits[p].push_back(*deposit);
    rays_cast += own_rays;
  });
  rays += rays_cast;
  for (const std::vector<Deposit>& list : deposits)
    for (const Deposit& deposit : list)
      if (mesh.area(deposit.element) > 0.0)
        irradiance[deposit.element] += C3d(deposit.power) * (1.0 / mesh.area(deposit.element));
  return irradiance;
}

}  // namespace twopass
