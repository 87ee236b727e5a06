#include "radiosity/caustic_map.h"

#include <algorithm>
#include <bit>

namespace twopass {

namespace {

// Disks reach as far as the smallest cells with so many particles: on a plane they have about three times as many.
// Of such that carry unequal power, those that carry little count for less.
constexpr double least_particles = 64.0;
// The largest and the smallest disks, as powers of two of the scene's largest edge.
constexpr int coarsest = 5, finest = 12;

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
  Builder(const Scene& scene, CausticMap& map) : map_(map), bounds_(scene.bounds()) {}

  void build(std::span<const CausticParticle> particles) {
    Found found;
    for (const CausticParticle& particle : particles)
      if (particle.is_caustic) found.push_back(&particle);
    if (found.empty()) return;
    const float edge = max_component(V3f(bounds_.max - bounds_.min));
    map_.origin_ = bounds_.min;
    edge_ = edge;
    const auto coordinate = [&](float x) {
      return static_cast<std::uint32_t>(std::clamp(x / edge * 0x1p12f, 0.0f, 0x1p12f - 1.0f));
    };
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    for (std::uint32_t i = 0; i < found.size(); ++i) {
      const V3f at = found[i]->position - bounds_.min;
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

 private:
  using Found = std::vector<const CausticParticle*>;

  // The number of particles of equal power of which the sum would be as noisy.
  static double effective_number(const Found& found,
                                 std::span<const std::pair<std::uint64_t, std::uint32_t>> cell) {
    double sum = 0.0, squares = 0.0;
    for (const auto& [code, particle] : cell) {
      const auto power = static_cast<double>(mean_component(found[particle]->power));
      sum += power;
      squares += power * power;
    }
    return squares > 0.0 ? sum * sum / squares : 0.0;
  }

  // (R49): the particles of a cell with enough of them, of the depth above the given one: those of its parts with
  // enough have smaller disks, the others its own, for a single particle among few would show.
  void descend(const Found& found, std::span<const std::pair<std::uint64_t, std::uint32_t>> cell, int depth) {
    for (std::size_t begin = 0; begin < cell.size();) {
      std::size_t end = begin;
      const int shift = 3 * (finest - depth - 1);
      while (end < cell.size() && (depth == finest || cell[end].first >> shift == cell[begin].first >> shift)) ++end;
      if (depth < finest &&
          (depth < coarsest || effective_number(found, cell.subspan(begin, end - begin)) >= least_particles)) {
        descend(found, cell.subspan(begin, end - begin), depth + 1);
      } else {
        const int level = std::clamp(depth - 1, coarsest, finest) - coarsest;
        for (std::size_t i = begin; i < end; ++i) {
          const CausticParticle& own = *found[cell[i].second];
          map_.levels_[static_cast<std::size_t>(level)].particle.push_back(
              {own.position, own.normal, own.power, own.light});
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

  CausticMap& map_;
  Box3f bounds_;
  float edge_ = 0.0f;
};

CausticMap::CausticMap(const Scene& scene, const CausticParticles& particles) {
  Builder(scene, *this).build(particles.all());
}

std::size_t CausticMap::particles() const {
  std::size_t sum = 0;
  for (const Level& level : levels_) sum += level.particle.size();
  return sum;
}

}  // namespace twopass
