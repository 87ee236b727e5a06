// Light that lamps throw onto surfaces over mirrors, glass and metals, kept as the particles that carry it: finer
// than elements, and found where paths from the camera would find a small lamp by chance.
#pragma once

#include <vector>

#include "radiosity/caustic_particles.h"
#include "render/core/sampler.h"

namespace twopass {

/// The irradiance L (S|G)+ D from emitting shapes: over one or more surfaces that scatter without diffusing, to the
/// first that diffuses. A particle's power is spread over a disk around it that is the smaller the more particles
/// there are (R49). Const and thread-safe once built; the same bits on any number of threads.
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
    for (const Level& level : levels_) {
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
        for (std::uint32_t i = cell->begin; i < cell->end; ++i) add(level, level.particle[i], point, use);
      }
    }
  }

 private:
  struct Particle {
    V3f position, normal;  // of the surface, on the side where it arrives
    C3f power;
    std::uint32_t light;
  };
  struct Cell {
    std::uint64_t key;  // 0: nothing is here
    std::uint32_t begin, end;
  };
  // The particles with disks of one radius.
  struct Level {
    float radius, cells_a_unit;      // cells are twice as large as the radius
    std::vector<Particle> particle;  // by cell
    std::vector<Cell> cell;          // hashed by key; a power of two
    [[nodiscard]] const Cell* find(std::uint64_t key) const {
      for (std::size_t slot = hash_word(key);; ++slot) {
        const Cell& found = cell[slot & (cell.size() - 1)];
        if (found.key == key) return &found;
        if (found.key == 0) return nullptr;
      }
    }
  };

  // Of cells numbered from 1 on, so that none has the key 0.
  static std::uint64_t key_of(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return std::uint64_t{x} << 42 | std::uint64_t{y} << 21 | std::uint64_t{z};
  }

  // Only what lies on the same surface, more or less flat, facing the same way.
  template <class Use>
  static void add(const Level& level, const Particle& particle, const SurfacePoint& point, const Use& use) {
    constexpr float least_cosine = 0.8f, thickness = 0.2f;
    const V3f offset = particle.position - point.position;
    const float height = offset.dot(point.geometric_normal);
    const float r2 = level.radius * level.radius, d2 = offset.length2() - height * height;
    if (d2 >= r2 || std::abs(height) > thickness * level.radius ||
        particle.normal.dot(point.geometric_normal) < least_cosine)
      return;
    use(particle.power * ((1.0f - d2 / r2) * 2.0f / (pi_f * r2)), particle.light);
  }

  class Builder;

  V3f origin_{0.0f};
  std::vector<Level> levels_;
};

}  // namespace twopass
