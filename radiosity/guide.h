// Where the light comes from, by the solution: densities of directions that gather rays and paths can be drawn
// from. It knows no camera. It is never trusted: whoever draws from it divides by its density.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "radiosity/solution.h"

namespace twopass {

struct GuideOptions {
  /// Edge of a cell over the largest edge of the scene's bounds. Groups of cells are four times as large.
  float cell_size = 0.025f;
  /// Cells are made larger until there are at most so many.
  std::size_t max_cells = 16384;
  int rays_per_bin = 1;
  /// Part of the density that is spread evenly, in (0, 1]: what the few rays have missed is found all the same.
  float uniform_share = 0.1f;
  std::uint32_t seed = 0;
  /// What lamps send straight over mirrors, glass and metals is not looked for, either.
  bool without_caustics = false;
  /// By element: whether anyone will ask there; empty: everywhere. Cells where nobody asks have no guide, and
  /// what is learnt there is missing in those around.
  std::vector<bool> wanted{};
};

/// For each cell (the elements of one cube of space that face nearly the same way) a histogram of the radiance
/// that arrives from surfaces, over the hemisphere as a square (R41): equal areas have equal cosine-weighted
/// solid angle, so the densities are those of radiance times cosine. Light straight from emitters and sky is
/// left out, for next-event estimation finds it. Const and thread-safe once built.
class Guide {
  struct Cell;

 public:
  static constexpr int rows = 24;     ///< of the square: rings of equal sin^2 of the angle with the normal
  static constexpr int columns = 32;  ///< sectors around the normal

  /// Casts rays_per_bin x rows x columns rays a cell. The same on any number of threads. REQUIRES: options in
  /// range.
  Guide(const Scene& scene, const Solution& solution, const GuideOptions& options = {});

  /// The density at one point of a surface, of directions on its viewer's side. REQUIRES: the guide outlives
  /// it.
  class Lobe {
   public:
    /// There is no guide here: nothing else may be called.
    [[nodiscard]] bool empty() const { return cell_ == nullptr; }
    struct Direction {
      V3f direction;  ///< unit, in the world
      float pdf_w;    ///< per steradian
    };
    /// The row that a number in [0, 1) leads to; asks for what sample() needs of it, so that it is at hand
    /// later.
    [[nodiscard]] int row_of(float u) const;
    /// Monotone in each coordinate of u within rows of the histogram, so that stratified numbers stay
    /// stratified.
    [[nodiscard]] Direction sample(const V2f& u) const { return sample(u, row_of(u.y)); }
    /// The same where the row is known. REQUIRES: row = row_of(u.y).
    [[nodiscard]] Direction sample(const V2f& u, int row) const;
    /// The density with which sample() draws a unit direction; 0 below the surface.
    [[nodiscard]] float pdf_w(const V3f& direction) const;

   private:
    friend class Guide;
    const Cell* cell_ = nullptr;
    Frame frame_;
  };
  [[nodiscard]] Lobe at(const SurfacePoint& point) const {
    const std::uint32_t element = mesh_->find(point);
    return element == no_index ? Lobe() : at(element, point.geometric_normal);
  }
  /// The same where the element is known.
  [[nodiscard]] Lobe at(std::uint32_t element, const V3f& geometric_normal) const {
    Lobe lobe;
    const Place& place = place_[element];
    if (place.sign == 0.0f) return lobe;
    lobe.cell_ = &cells_[place.cell];
    __builtin_prefetch(lobe.cell_);
    lobe.frame_ = frame_around(geometric_normal, place.sign);
    return lobe;
  }

  /// Asks for what is kept of an element, so that it is at hand when at() is.
  void prefetch(std::uint32_t element) const { __builtin_prefetch(&place_[element]); }

  [[nodiscard]] std::size_t cell_count() const { return cells_.size(); }
  [[nodiscard]] std::uint64_t rays() const { return rays_; }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  // Cumulative distributions, without the last entry, which is the whole: of the rows in units of 2^-16, and
  // within each row in units of 2^-8. What a direction is drawn by is in two lines of a cache.
  struct alignas(64) Cell {
    std::array<std::uint16_t, rows> row;
    alignas(32) std::array<std::array<std::uint8_t, columns>, rows> column;
  };
  // Where an element belongs. All of a cell have one sign, so that their frames turn with the normal without a
  // jump; 0: no light arrives.
  struct Place {
    std::uint32_t cell;
    float sign;
  };
  // As Frame (Duff et al. 2017), but for a sign that does not hang on a vertical wall's rounding. REQUIRES:
  // sign is that of normal.z where |normal.z| > 0.9.
  [[nodiscard]] static Frame frame_around(const V3f& normal, float sign) {
    Frame frame;
    const float a = -1.0f / (sign + normal.z), b = normal.x * normal.y * a;
    frame.s = V3f(1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    frame.t = V3f(b, sign + normal.y * normal.y * a, -normal.y);
    frame.n = normal;
    return frame;
  }
  class Builder;

  const ElementMesh* mesh_;
  std::vector<Place> place_;  // by element
  std::vector<Cell> cells_;
  std::uint64_t rays_ = 0;
};

}  // namespace twopass
