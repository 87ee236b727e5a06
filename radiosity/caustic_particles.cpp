#include "radiosity/caustic_particles.h"

#include <atomic>

#include "materials/lobes.h"
#include "radiosity/lamp_surfaces.h"
#include "radiosity/specular_path.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/core/warp.h"

namespace twopass {

namespace {

// Where particles are aimed at: bins of a lamp's directions, rings of equal cosine-weighted solid angle by
// sectors.
constexpr std::uint32_t rings = 8, sectors = 16, bins = rings * sectors;
constexpr std::size_t most_groups = 64;  // of lamps with directions of their own
constexpr std::size_t pilot_particles = std::size_t{1} << 17;
constexpr double uniform_share = 0.1;
// The part of all light above which all particles are worth their time. What coats reflect is weak and wide: so
// many do for that alone.
constexpr double much = 0.02;
constexpr std::size_t particles_of_coats = std::size_t{1} << 17;
constexpr std::size_t least_particles = std::size_t{1} << 14;
constexpr std::size_t piece = 4096;

bool has_other_than_diffuse(const Scene& scene) {
  return std::ranges::any_of(scene.shapes(), [&](const Shape& shape) {
    const Material& material = scene.description().materials[shape.material];
    return is_more_than_diffuse(material.side[front]) || is_more_than_diffuse(material.side[back]);
  });
}

class Shooter {
 public:
  Shooter(const Scene& scene, std::uint32_t seed)
      : scene_(scene),
        seed_(seed),
        lamps_(lamp_surfaces(scene)),
        choice_(choice_by_power(lamps_)),
        groups_(lamps_.size() <= most_groups ? lamps_.size() : 1) {}
  [[nodiscard]] bool empty() const { return choice_.empty(); }
  [[nodiscard]] std::size_t bin_count() const { return groups_ * bins; }

  // The probability of each bin where nothing is known: that of light.
  [[nodiscard]] std::vector<double> even() const {
    std::vector<double> p(bin_count());
    for (std::size_t b = 0; b < p.size(); ++b)
      p[b] = (groups_ == 1 ? 1.0
                           : static_cast<double>(choice_.probability(static_cast<std::uint32_t>(b / bins)))) /
             bins;
    return p;
  }

  // Shoots one of so many particles out of a bin that is chosen `over` times as often as light would: adds
  // where it arrives.
  void shoot(std::size_t bin, double over, const V2f& in_bin, std::size_t count, Sampler& sampler,
             std::vector<CausticParticle>& arrived, std::uint64_t& rays) const {
    const V2f u = sampler.next_2d();
    std::uint32_t index = 0;
    V2f place = u;
    float probability = 1.0f;
    if (groups_ == 1) {
      const auto chosen = choice_.sample(u.x);
      index = chosen.index;
      place.x = chosen.remapped;
      probability = chosen.probability;
    } else {
      index = static_cast<std::uint32_t>(bin / bins);
      probability = choice_.probability(index);
    }
    const LampSurface& lamp = lamps_[index];
    const ElementPoint start = lamp.patch.sample(place);
    const auto ring = static_cast<float>(bin % bins / sectors), sector = static_cast<float>(bin % sectors);
    const V3f direction =
        Frame(V3f(start.normal))
            .to_world(square_to_cosine_hemisphere({(ring + in_bin.x) / static_cast<float>(rings),
                                                   (sector + in_bin.y) / static_cast<float>(sectors)}));
    const Ray ray{start.ray_position(), direction};
    const Hit hit = scene_.caster().intersect(ray);
    ++rays;
    if (hit.escaped()) return;
    const SurfacePoint point = scene_.surface_point(ray, hit);
    if (!is_more_than_diffuse(scene_.side(point))) return;
    const auto share = static_cast<float>(
        pi * lamp.patch.area / (static_cast<double>(probability) * over * static_cast<double>(count)));
    const C3f radiance = radiance_at(scene_, lamp, start, rays);
    SpecularPath path(scene_, ray, point, Carried::power, sampler);
    bool is_caustic = scene_.side(point).scatters_without_diffusing();
    while (path.next() && !path.end().escaped) {
      const SurfacePoint& end = path.end().point;
      const C3f power = radiance * path.end().weight * share;
      if (!is_black(power) && !is_black(scene_.side(end).traits().mean_diffuse_reflectance))
        arrived.push_back({end.shape, end.primitive, end.u, end.v, end.position, end.geometric_normal, power,
                           lamp.light, end.side, is_caustic});
      is_caustic = false;
    }
    rays += path.rays();
  }

  [[nodiscard]] Sampler sampler(std::uint32_t round, std::uint32_t k) const { return {seed_, round, k}; }
  [[nodiscard]] double power() const { return pi * choice_.total(); }

 private:
  const Scene& scene_;
  std::uint32_t seed_;
  std::vector<LampSurface> lamps_;
  DiscreteDistribution choice_;
  std::size_t groups_;
};

// What so many particles bring, with the bin of each; in their order, on any number of threads.
struct Shot {
  std::vector<CausticParticle> particles;
  std::vector<std::uint32_t> bin;
};
Shot shoot_all(const Shooter& shooter, std::uint32_t round, std::size_t count,
               const DiscreteDistribution& choice, const std::vector<double>& even, std::uint64_t& rays) {
  std::vector<Shot> parts((count + piece - 1) / piece);
  std::atomic<std::uint64_t> rays_cast{0};
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    throw_if_interrupted();
    std::uint64_t own_rays = 0;
    for (std::size_t p = begin; p < end; ++p)
      for (std::size_t k = p * piece; k < std::min(count, (p + 1) * piece); ++k) {
        Sampler sampler = shooter.sampler(round, static_cast<std::uint32_t>(k));
        V2f u = sampler.next_2d();
        const DiscreteDistribution::Choice bin = choice.sample(u.x);
        u.x = bin.remapped;
        shooter.shoot(bin.index, static_cast<double>(bin.probability) / even[bin.index], u, count, sampler,
                      parts[p].particles, own_rays);
        parts[p].bin.resize(parts[p].particles.size(), bin.index);
      }
    rays_cast += own_rays;
  });
  rays += rays_cast;
  Shot all;
  for (const Shot& part : parts) {
    all.particles.insert(all.particles.end(), part.particles.begin(), part.particles.end());
    all.bin.insert(all.bin.end(), part.bin.begin(), part.bin.end());
  }
  return all;
}

}  // namespace

SurfacePoint CausticParticle::point() const {
  SurfacePoint point;
  point.shape = shape;
  point.primitive = primitive;
  point.u = u;
  point.v = v;
  point.side = side;
  point.position = position;
  point.geometric_normal = normal;
  return point;
}

CausticParticles::CausticParticles(const Scene& scene, const CausticParticlesOptions& options) {
  if (!has_other_than_diffuse(scene)) return;
  const Shooter shooter(scene, options.seed);
  if (shooter.empty()) return;
  const std::vector<double> even = shooter.even();
  std::vector<double> aim(shooter.bin_count(), 0.0);
  double power = 0.0, caustic_power = 0.0;
  const Shot pilot = shoot_all(shooter, 0, std::min(pilot_particles, options.particles),
                               DiscreteDistribution(even), even, rays_);
  for (std::size_t i = 0; i < pilot.particles.size(); ++i) {
    const double own = mean_component(pilot.particles[i].power);
    aim[pilot.bin[i]] += own;
    power += own;
    if (pilot.particles[i].is_caustic) caustic_power += own;
  }
  if (!(power > 0.0)) return;
  // As often as light arrives from there, of which the root is less wrong where few have arrived.
  double sum = 0.0;
  for (std::size_t b = 0; b < aim.size(); ++b) sum += aim[b] = std::sqrt(aim[b] * even[b]);
  for (std::size_t b = 0; b < aim.size(); ++b)
    aim[b] = uniform_share * even[b] + (1.0 - uniform_share) * aim[b] / sum;
  const double wanted =
      static_cast<double>(options.particles) * std::min(1.0, caustic_power / (much * shooter.power()));
  const std::size_t least = power > caustic_power ? particles_of_coats : least_particles;
  const std::size_t count = std::max(static_cast<std::size_t>(wanted), std::min(least, options.particles));
  particles_ = shoot_all(shooter, 1, count, DiscreteDistribution(aim), even, rays_).particles;
}

}  // namespace twopass
