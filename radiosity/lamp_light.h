// Light straight from flat lamps in closed form, where it is certain that nothing reaches into it.
#pragma once

#include <optional>
#include <span>

#include "radiosity/visible_exchange.h"
#include "render/scene/scene.h"

namespace twopass {

/// The lamps of a scene as polygons, and what stands in their light. Const and thread-safe once built.
class LampLight {
 public:
  /// Which lamps a surface sees: a bit each.
  using Lamps = std::uint64_t;

  /// REQUIRES: the scene outlives it.
  explicit LampLight(const Scene& scene);

  /// Whether the scene's light is of a kind of which anything is known: at most 64 flat polygons of even
  /// radiance, nothing else that shines, no masks, and not more than 2048 polygons in all.
  [[nodiscard]] bool is_known() const { return !lamps_.empty(); }

  /// The lamps that shine on the front of all of a flat polygon, all others being hidden from all of it (R43);
  /// nothing where it is not certain that it is so. REQUIRES: is_known(), at most four corners, not degenerate.
  [[nodiscard]] std::optional<Lamps> seen_from(const Polygon& polygon) const;

  /// Irradiance from the given lamps in full view at a point with a unit normal, W/m2: (R2), exact.
  [[nodiscard]] C3d irradiance(const V3d& point, const V3d& normal, Lamps lamps) const;
  /// The same of one lamp, the k-th bit of Lamps. REQUIRES: there is one.
  [[nodiscard]] C3d irradiance_of(int k, const V3d& point, const V3d& normal) const;
  /// Whether none of the given lamps reaches below a plane of unit normal.
  [[nodiscard]] bool are_above(Lamps lamps, const V3d& point, const V3d& normal) const;
  [[nodiscard]] std::size_t count() const { return lamps_.size(); }
  /// The k-th lamp, seen from its shining side, and what it emits, W/m2.
  [[nodiscard]] const Polygon& polygon(std::size_t k) const { return lamps_[k].polygon; }
  [[nodiscard]] const C3d& exitance(std::size_t k) const { return lamps_[k].exitance; }
  /// The number of a lamp as a light (Lights): of the shape that emits.
  [[nodiscard]] std::uint32_t number_of(int k) const { return lamps_[static_cast<std::size_t>(k)].shape; }
  /// How many tests seen_from() makes at most.
  [[nodiscard]] std::size_t work() const { return lamps_.size() * polygons_; }

 private:
  struct Lamp {
    Polygon polygon;  // its shining side is the front
    C3d exitance;
    std::uint32_t shape;
  };
  bool add_shape(const Scene& scene, std::uint32_t number, std::vector<Polygon>& surfaces,
                 std::vector<Polygon>& surroundings);
  [[nodiscard]] bool stands_in_solid(const Polygon& polygon) const;

  std::vector<Lamp> lamps_;
  std::size_t polygons_ = 0;
  std::vector<Imath::Box3d> solids_;   // around what is no polygon
  std::optional<Blockers> surfaces_;   // what hides for certain
  std::optional<Blockers> obstacles_;  // what may hide: surfaces and solids
};

}  // namespace twopass
