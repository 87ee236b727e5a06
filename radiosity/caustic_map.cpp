#include "radiosity/caustic_map.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>

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
// The part of all light above which all particles are worth their time.
constexpr double much = 0.02;
// Cells with fewer particles are not divided: their disks have two to five times as many.
constexpr std::size_t least_particles = 128;
// The largest and the smallest disks, as powers of two of the scene's largest edge.
constexpr int coarsest = 5, finest = 12;
constexpr std::size_t piece = 4096;

// A particle that has arrived.
struct Arrival {
  V3f position, normal;
  C3f power;
  std::uint32_t light;
};

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
      p[b] = (groups_ == 1 ? 1.0 : static_cast<double>(choice_.probability(static_cast<std::uint32_t>(b / bins)))) /
             bins;
    return p;
  }

  // Shoots particle k of so many out of a bin that is chosen `over` times as often as light would; false: it
  // arrives nowhere.
  bool shoot(std::size_t bin, double over, const V2f& in_bin, std::size_t count, Sampler& sampler,
             Arrival& arrival, std::uint64_t& rays) const {
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
    const V3f direction = Frame(V3f(start.normal)).to_world(square_to_cosine_hemisphere(
        {(ring + in_bin.x) / static_cast<float>(rings), (sector + in_bin.y) / static_cast<float>(sectors)}));
    const Ray ray{start.ray_position(), direction};
    const Hit hit = scene_.caster().intersect(ray);
    ++rays;
    if (hit.escaped()) return false;
    const SurfacePoint point = scene_.surface_point(ray, hit);
    if (!scene_.side(point).scatters_without_diffusing()) return false;
    SpecularPath path(scene_, ray, point, Carried::power, sampler);
    const bool arrives = path.next() && !path.end().escaped;
    rays += path.rays();
    if (!arrives) return false;
    const SurfacePoint& end = path.end().point;
    if (is_black(scene_.side(end).traits().mean_diffuse_reflectance)) return false;
    const auto share = static_cast<float>(pi * lamp.patch.area /
                                          (static_cast<double>(probability) * over * static_cast<double>(count)));
    const C3f radiance = radiance_at(scene_, lamp, start, rays);
    arrival = {end.position, end.geometric_normal, radiance * path.end().weight * share, lamp.light};
    return !is_black(arrival.power);
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

// Bits of 12 coordinates' worth each, interleaved: cells of all sizes are ranges in this order.
std::uint64_t interleaved(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  std::uint64_t code = 0;
  for (int bit = finest - 1; bit >= 0; --bit)
    code = code << 3 | (x >> bit & 1u) << 2 | (y >> bit & 1u) << 1 | (z >> bit & 1u);
  return code;
}

}  // namespace

class CausticMap::Builder {
 public:
  Builder(const Scene& scene, const CausticMapOptions& options, CausticMap& map)
      : options_(options), map_(map), shooter_(scene, options.seed), bounds_(scene.bounds()) {}

  void build() {
    if (shooter_.empty()) return;
    std::vector<double> even = shooter_.even(), found(shooter_.bin_count(), 0.0);
    double power = 0.0;
    for (const auto& [bin, arrival] : shoot_all(0, pilot_particles, DiscreteDistribution(even), even)) {
      const double own = mean_component(arrival.power);
      found[bin] += own;
      power += own;
    }
    if (!(power > 0.0)) return;
    // As often as light arrives from there, of which the root is less wrong where few have arrived.
    double sum = 0.0;
    for (std::size_t b = 0; b < found.size(); ++b) sum += found[b] = std::sqrt(found[b] * even[b]);
    for (std::size_t b = 0; b < found.size(); ++b)
      found[b] = uniform_share * even[b] + (1.0 - uniform_share) * found[b] / sum;
    const double wanted = static_cast<double>(options_.particles) * std::min(1.0, power / (much * shooter_.power()));
    const auto count = std::max<std::size_t>(static_cast<std::size_t>(wanted), std::size_t{1} << 14);
    arrange(shoot_all(1, count, DiscreteDistribution(found), even));
  }

 private:
  using Found = std::vector<std::pair<std::uint32_t, Arrival>>;  // with the bin

  // In the order of particles, on any number of threads.
  Found shoot_all(std::uint32_t round, std::size_t count, const DiscreteDistribution& choice,
                  const std::vector<double>& even) {
    std::vector<Found> parts((count + piece - 1) / piece);
    std::atomic<std::uint64_t> rays{0};
    parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
      throw_if_interrupted();
      std::uint64_t own_rays = 0;
      for (std::size_t p = begin; p < end; ++p)
        for (std::size_t k = p * piece; k < std::min(count, (p + 1) * piece); ++k) {
          Sampler sampler = shooter_.sampler(round, static_cast<std::uint32_t>(k));
          V2f u = sampler.next_2d();
          const DiscreteDistribution::Choice bin = choice.sample(u.x);
          u.x = bin.remapped;
          Arrival arrival;
          if (shooter_.shoot(bin.index, static_cast<double>(bin.probability) / even[bin.index], u, count, sampler,
                             arrival, own_rays))
            parts[p].emplace_back(bin.index, arrival);
        }
      rays += own_rays;
    });
    map_.rays_ += rays;
    Found all;
    for (const Found& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
  }

  void arrange(const Found& found) {
    const float edge = max_component(V3f(bounds_.max - bounds_.min));
    map_.origin_ = bounds_.min;
    edge_ = edge;
    const auto coordinate = [&](float x) {
      return static_cast<std::uint32_t>(std::clamp(x / edge * 0x1p12f, 0.0f, 0x1p12f - 1.0f));
    };
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    for (std::uint32_t i = 0; i < found.size(); ++i) {
      const V3f at = found[i].second.position - bounds_.min;
      order.emplace_back(interleaved(coordinate(at.x), coordinate(at.y), coordinate(at.z)), i);
    }
    std::sort(order.begin(), order.end());
    for (int level = coarsest; level <= finest; ++level) {
      const float radius = std::ldexp(edge, -level);
      map_.levels_.push_back({radius, 0.5f / radius, {}, {}});
    }
    descend(found, order, 0);
    std::erase_if(map_.levels_, [](const Level& level) { return level.particle.empty(); });
    for (Level& level : map_.levels_) index(level);
  }

  // (R49): the particles of a cell of the given depth, of which the smallest cells with enough of them tell the
  // radius.
  void descend(const Found& found, std::span<const std::pair<std::uint64_t, std::uint32_t>> cell, int depth) {
    for (std::size_t begin = 0; begin < cell.size();) {
      std::size_t end = begin;
      const int shift = 3 * (finest - depth - 1);
      while (end < cell.size() && (depth == finest || cell[end].first >> shift == cell[begin].first >> shift)) ++end;
      if (depth < finest && (depth < coarsest || end - begin >= least_particles)) {
        descend(found, cell.subspan(begin, end - begin), depth + 1);
      } else {
        const int level = std::clamp(depth, coarsest, finest) - coarsest;
        for (std::size_t i = begin; i < end; ++i) {
          const Arrival& arrival = found[cell[i].second].second;
          map_.levels_[static_cast<std::size_t>(level)].particle.push_back(
              {arrival.position, arrival.normal, arrival.power, arrival.light});
        }
      }
      begin = end;
    }
  }

  void index(Level& level) const {
    const auto key = [&](const Particle& particle) {
      const V3f at = (particle.position - map_.origin_) * level.cells_a_unit;
      const auto cell = [](float x) { return static_cast<std::uint32_t>(std::clamp(x, 0.0f, 0x1p20f)) + 1u; };
      return key_of(cell(at.x), cell(at.y), cell(at.z));
    };
    std::stable_sort(level.particle.begin(), level.particle.end(),
                     [&](const Particle& a, const Particle& b) { return key(a) < key(b); });
    std::vector<Cell> cells;
    for (std::uint32_t i = 0; i < level.particle.size(); ++i) {
      const std::uint64_t own = key(level.particle[i]);
      if (cells.empty() || cells.back().key != own) cells.push_back({own, i, i});
      cells.back().end = i + 1;
    }
    level.cell.assign(std::bit_ceil(2 * cells.size() + 1), Cell{0, 0, 0});
    for (const Cell& cell : cells) {
      std::size_t slot = hash_word(cell.key);
      while (level.cell[slot & (level.cell.size() - 1)].key != 0) ++slot;
      level.cell[slot & (level.cell.size() - 1)] = cell;
    }
  }

  CausticMapOptions options_;
  CausticMap& map_;
  Shooter shooter_;
  Box3f bounds_;
  float edge_ = 0.0f;
};

CausticMap::CausticMap(const Scene& scene, const CausticMapOptions& options) {
  Builder(scene, options, *this).build();
}

std::size_t CausticMap::particles() const {
  std::size_t sum = 0;
  for (const Level& level : levels_) sum += level.particle.size();
  return sum;
}

}  // namespace twopass
