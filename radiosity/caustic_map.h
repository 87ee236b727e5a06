// Light that lamps throw onto surfaces over mirrors, glass and metals, kept as the particles that carry it:
// finer than elements, and found where paths from the camera would find a small lamp by chance.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include "radiosity/caustic_particles.h"
#include "render/core/sampler.h"

namespace twopass {

/// The irradiance L (S|G)+ D from emitting shapes: over one or more surfaces that scatter without diffusing, to
/// the first that diffuses. A particle's power is spread over a disk around it that is the smaller the more
/// particles there are (R49). Const and thread-safe once built; the same bits on any number of threads.
class CausticMap {
 public:
  /// Of the particles that are caustics; they may be forgotten afterwards.
  CausticMap(const Scene& scene, const CausticParticles& particles);

  /// No particle has arrived anywhere.
  [[nodiscard]] bool empty() const { return levels_.empty(); }
  [[nodiscard]] std::size_t particles() const;

  /// Irradiance on the viewer's side of a point, W/m2.
  [[nodiscard]] C3f irradiance(const SurfacePoint& point) const {
    C3f sum(0.0f);
    visit(point, [&](const C3f& part, std::uint32_t) { sum += part; });
    return sum;
  }
  /// The same in parts: calls `use(irradiance, light)`, with the light's number as in Lights.
  template <class Use>
  void visit(const SurfacePoint& point, const Use& use) const {
    for (unsigned levels = levels_at((point.position - origin_) * blocks_a_unit_); levels != 0;
         levels &= levels - 1) {
      const Level& level = levels_[static_cast<std::size_t>(std::countr_zero(levels))];
      // Disks reach less than a cell's edge: the eight cells around the nearest corner of cells hold all.
      const V3f at = (point.position - origin_) * level.cells_a_unit;
      std::uint32_t low[3];
      bool is_outside = false;
      for (int axis = 0; axis < 3; ++axis) {
        const float place = at[axis] + 0.5f;  // cells are numbered from 1
        is_outside = is_outside || !(place >= 0.0f) || !(place < 0x1p20f);
        low[axis] = is_outside ? 0u : static_cast<std::uint32_t>(place);
      }
      if (is_outside) continue;
      for (std::uint32_t k = 0; k < 8; ++k) {
        const Cell* cell = level.find(key_of(low[0] + (k & 1u), low[1] + (k >> 1 & 1u), low[2] + (k >> 2)));
        if (!cell) continue;
        for (std::uint32_t i = cell->begin; i < cell->end; i += lanes) add(level, i, cell->end, point, use);
      }
    }
  }

 private:
  struct Arrival {
    V3f normal;  // of the surface, on the side where it arrives
    C3f power;
    std::uint32_t light;
  };
  struct Cell {
    std::uint64_t key;  // 0: nothing is here
    std::uint32_t begin, end;
  };
  // The particles with disks of one radius.
  struct Level {
    float radius, cells_a_unit;  // cells are twice as large as the radius
    // By particle, in the order of cells. Of most, only the positions are looked at, several at a time.
    std::array<std::vector<float>, 3> position;  // by axis, and as many more as can be looked at with the last
    std::vector<Arrival> arrival;
    std::vector<Cell> cell;  // hashed by key; a power of two
    [[nodiscard]] V3f at(std::uint32_t particle) const {
      return {position[0][particle], position[1][particle], position[2][particle]};
    }
    [[nodiscard]] const Cell* find(std::uint64_t key) const {
      for (std::size_t slot = hash_word(key);; ++slot) {
        const Cell& found = cell[slot & (cell.size() - 1)];
        if (found.key == key) return &found;
        if (found.key == 0) return nullptr;
      }
    }
  };

  // Blocks of space, and in bits which levels' disks reach into each: few do into most.
  static constexpr int blocks_of_an_edge = 32;
  static std::size_t block(int x, int y, int z) {
    return static_cast<std::size_t>((x * blocks_of_an_edge + y) * blocks_of_an_edge + z);
  }
  // The nearest to a coordinate in blocks: points at the bounds may be rounded out of them.
  static int nearest_block(float x) {
    return x > 0.0f ? static_cast<int>(std::min(x, blocks_of_an_edge - 1.0f)) : 0;
  }
  // Of a place in blocks.
  [[nodiscard]] unsigned levels_at(const V3f& place) const {
    if (levels_of_block_.empty()) return 0;
    return levels_of_block_[block(nearest_block(place.x), nearest_block(place.y), nearest_block(place.z))];
  }

  // Of cells numbered from 1 on, so that none has the key 0.
  static std::uint64_t key_of(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return std::uint64_t{x} << 42 | std::uint64_t{y} << 21 | std::uint64_t{z};
  }

  // So many particles are looked at side by side.
  static constexpr std::uint32_t lanes = 4;
  using Floats [[gnu::vector_size(16)]] = float;
  using Pairs [[gnu::vector_size(16)]] = std::int64_t;
  // Of those from `begin` on, at most to `end`: only what lies on the same surface, more or less flat, facing
  // the same way.
  template <class Use>
  static void add(const Level& level, std::uint32_t begin, std::uint32_t end, const SurfacePoint& point,
                  const Use& use) {
    constexpr float least_cosine = 0.8f, thickness = 0.2f;
    const V3f normal = point.geometric_normal;
    const float r2 = level.radius * level.radius, most_height = thickness * level.radius;
    Floats offset[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::memcpy(&offset[axis], level.position[axis].data() + begin, sizeof(Floats));
      offset[axis] -= point.position[static_cast<int>(axis)];
    }
    const Floats height = offset[0] * normal.x + offset[1] * normal.y + offset[2] * normal.z;
    const Floats d2 = offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2] - height * height;
    const auto is_near = (d2 < r2) & (height <= most_height) & (height >= -most_height);
    if (const Pairs pairs = reinterpret_cast<Pairs>(is_near); (pairs[0] | pairs[1]) == 0) return;
    for (std::uint32_t k = 0; k < std::min(lanes, end - begin); ++k) {
      if (!is_near[k]) continue;
      const Arrival& arrival = level.arrival[begin + k];
      if (arrival.normal.dot(normal) < least_cosine) continue;
      use(arrival.power * ((1.0f - d2[k] / r2) * 2.0f / (pi_f * r2)), arrival.light);
    }
  }

  class Builder;

  V3f origin_{0.0f};
  float blocks_a_unit_ = 0.0f;
  std::vector<Level> levels_;
  std::vector<std::uint8_t> levels_of_block_;  // bit k: levels_[k]; empty without particles
};

}  // namespace twopass
