#include "radiosity/caustic_map.h"

#include <algorithm>
#include <bit>

namespace twopass {

namespace {

// Disks reach as far as the smallest cells with so many particles: on a plane they have about three times as
// many. Of such that carry unequal power, those that carry little count for less.
constexpr double least_particles = 64.0;
// The largest and the smallest disks, as powers of two of the scene's largest edge.
constexpr int coarsest = 5, finest = 12;
static_assert(finest - coarsest < 8, "the levels of a block are the bits of a byte");

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
      map_.levels_.push_back({radius, 0.5f / radius, {}, {}, {}});
    }
    descend(found, order, 0);
    std::erase_if(map_.levels_, [](const Level& level) { return level.arrival.empty(); });
    for (Level& level : map_.levels_) index(level);
    map_.blocks_a_unit_ = blocks_of_an_edge / edge;
    map_.levels_of_block_.resize(block(blocks_of_an_edge, 0, 0));
    for (std::size_t k = 0; k < map_.levels_.size(); ++k) mark_blocks(k);
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

  // (R49): the particles of a cell with enough of them, of the depth above the given one: those of its parts
  // with enough have smaller disks, the others its own, for a single particle among few would show.
  void descend(const Found& found, std::span<const std::pair<std::uint64_t, std::uint32_t>> cell, int depth) {
    for (std::size_t begin = 0; begin < cell.size();) {
      std::size_t end = begin;
      const int shift = 3 * (finest - depth - 1);
      while (end < cell.size() && (depth == finest || cell[end].first >> shift == cell[begin].first >> shift))
        ++end;
      if (depth < finest &&
          (depth < coarsest || effective_number(found, cell.subspan(begin, end - begin)) >= least_particles)) {
        descend(found, cell.subspan(begin, end - begin), depth + 1);
      } else {
        Level& level =
            map_.levels_[static_cast<std::size_t>(std::clamp(depth - 1, coarsest, finest) - coarsest)];
        for (std::size_t i = begin; i < end; ++i) {
          const CausticParticle& own = *found[cell[i].second];
          for (std::size_t axis = 0; axis < 3; ++axis)
            level.position[axis].push_back(own.position[static_cast<int>(axis)]);
          level.arrival.push_back({own.normal, own.power, own.light});
        }
      }
      begin = end;
    }
  }

  void index(Level& level) const {
    const auto key = [&](std::uint32_t particle) {
      const V3f at = (level.at(particle) - map_.origin_) * level.cells_a_unit;
      const auto cell = [](float x) { return static_cast<std::uint32_t>(std::clamp(x, 0.0f, 0x1p20f)) + 1u; };
      return key_of(cell(at.x), cell(at.y), cell(at.z));
    };
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    for (std::uint32_t i = 0; i < level.arrival.size(); ++i) order.emplace_back(key(i), i);
    std::sort(order.begin(), order.end());
    const Level before = level;
    std::vector<Cell> cells;
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      const auto [own, particle] = order[i];
      if (cells.empty() || cells.back().key != own) cells.push_back({own, i, i});
      cells.back().end = i + 1;
      level.arrival[i] = before.arrival[particle];
      for (std::size_t axis = 0; axis < 3; ++axis) level.position[axis][i] = before.position[axis][particle];
    }
    for (std::vector<float>& coordinate : level.position) coordinate.resize(order.size() + lanes);
    level.cell.assign(std::bit_ceil(2 * cells.size() + 1), Cell{0, 0, 0});
    for (const Cell& cell : cells) {
      std::size_t slot = hash_word(cell.key);
      while (level.cell[slot & (level.cell.size() - 1)].key != 0) ++slot;
      level.cell[slot & (level.cell.size() - 1)] = cell;
    }
  }

  // Those that the cubes around the level's disks touch, and a little more: coordinates are rounded.
  void mark_blocks(std::size_t k) const {
    const Level& level = map_.levels_[k];
    const V3f reach(1.01f * level.radius);
    for (std::uint32_t i = 0; i < level.arrival.size(); ++i) {
      const V3f position = level.at(i);
      const V3f low = (position - reach - map_.origin_) * map_.blocks_a_unit_;
      const V3f high = (position + reach - map_.origin_) * map_.blocks_a_unit_;
      for (int x = nearest_block(low.x); x <= nearest_block(high.x); ++x)
        for (int y = nearest_block(low.y); y <= nearest_block(high.y); ++y)
          for (int z = nearest_block(low.z); z <= nearest_block(high.z); ++z)
            map_.levels_of_block_[block(x, y, z)] |= static_cast<std::uint8_t>(1u << k);
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
  for (const Level& level : levels_) sum += level.arrival.size();
  return sum;
}

}  // namespace twopass
