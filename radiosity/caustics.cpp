#include "radiosity/caustics.h"

#include <atomic>

#include "materials/lobes.h"
#include "radiosity/lamp_surfaces.h"
#include "radiosity/specular_path.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

struct Deposit {
  std::uint32_t element;
  C3f power;
};
using Deposits = std::vector<Deposit>;

class Shooter {
 public:
  Shooter(const Scene& scene, const ElementMesh& mesh, std::size_t paths, std::uint32_t seed)
      : scene_(scene),
        mesh_(mesh),
        paths_(paths),
        seed_(seed),
        lamps_(lamp_surfaces(scene)),
        choice_(choice_by_power(lamps_)) {}

  [[nodiscard]] bool empty() const { return choice_.empty(); }

  // Adds the elements that particle k comes to over specular surfaces and glossy lobes.
  void shoot(std::uint32_t k, Deposits& deposits, std::uint64_t& rays) const {
    Sampler sampler(seed_, 0, k);
    const V2f u = sampler.next_2d();
    const auto choice = choice_.sample(u.x);
    const LampSurface& lamp = lamps_[choice.index];
    const ElementPoint start = lamp.patch.sample({choice.remapped, u.y});
    const V3f direction = Frame(V3f(start.normal)).to_world(square_to_cosine_hemisphere(sampler.next_2d()));
    const Ray ray{start.ray_position(), direction};
    const Hit hit = scene_.caster().intersect(ray);
    ++rays;
    if (hit.escaped()) return;
    const SurfacePoint point = scene_.surface_point(ray, hit);
    if (!is_more_than_diffuse(scene_.side(point))) return;
    const auto share =
        static_cast<float>(pi * lamp.patch.area / (choice.probability * static_cast<double>(paths_)));
    const C3f radiance = radiance_at(scene_, lamp, start, rays);
    SpecularPath path(scene_, ray, point, Carried::power, sampler);
    while (path.next()) {
      if (path.end().escaped) break;
      const std::uint32_t element = mesh_.find(path.end().point);
      if (element != no_index) deposits.push_back({element, radiance * path.end().weight * share});
    }
    rays += path.rays();
  }

 private:
  const Scene& scene_;
  const ElementMesh& mesh_;
  std::size_t paths_;
  std::uint32_t seed_;
  std::vector<LampSurface> lamps_;
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
  std::vector<Deposits> deposits((paths + piece - 1) / piece);
  std::atomic<std::uint64_t> rays_cast{0};
  parallel_for(deposits.size(), 1, [&](std::size_t begin, std::size_t end) {
    throw_if_interrupted();
    std::uint64_t own_rays = 0;
    for (std::size_t p = begin; p < end; ++p)
      for (std::size_t k = p * piece; k < std::min(paths, (p + 1) * piece); ++k)
        shooter.shoot(static_cast<std::uint32_t>(k), deposits[p], own_rays);
    rays_cast += own_rays;
  });
  rays += rays_cast;
  for (const Deposits& list : deposits)
    for (const Deposit& deposit : list)
      if (mesh.area(deposit.element) > 0.0)
        irradiance[deposit.element] += C3d(deposit.power) * (1.0 / mesh.area(deposit.element));
  return irradiance;
}

}  // namespace twopass
