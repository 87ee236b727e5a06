// What the fronts of whole shapes see of each other, counted along rays that go on behind what they hit.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "radiosity/pieces.h"
#include "render/scene/scene.h"

namespace twopass {

/// The fronts of all shapes, in pieces.
struct ShapeFronts {
  std::vector<Patch> patch;               ///< those of one shape stand together; none without area
  std::vector<std::uint32_t> shape;       ///< of each patch
  std::vector<std::uint32_t> first;       ///< by shape: its first patch; one more at the end
  std::vector<double> area;               ///< by shape
  std::vector<std::uint8_t> is_analytic;  ///< by shape
  std::size_t degenerate = 0;             ///< triangles left out because they have no area

  [[nodiscard]] std::size_t shapes() const { return area.size(); }
  [[nodiscard]] std::span<const Patch> patches_of(std::uint32_t s) const {
    return std::span(patch).subspan(first[s], first[s + 1] - first[s]);
  }
};

ShapeFronts collect_fronts(const Scene& scene);

/// Fronts that a straight line from a surface meets, in order.
struct FrontsMet {
  struct Front {
    std::uint32_t shape;
    bool first;  ///< nothing was hit before
  };
  std::vector<Front> fronts;
  bool escaped = false;   ///< the line hit nothing at all
  bool met_back = false;  ///< the first thing that it hit showed its back
};

/// Follows rays through everything.
class LineFollower {
 public:
  explicit LineFollower(const Scene& scene);
  /// All fronts on the ray, or, without `beyond_first`, its first hit alone. `met` is overwritten.
  void follow(Ray ray, bool beyond_first, FrontsMet& met) const;

 private:
  const Scene& scene_;
  std::size_t most_hits_ = 0;  // a line meets a triangle once and an analytic surface at most twice
};

/// Where the rays of all shapes went.
struct ShapeRayCounts {
  std::uint32_t rays = 0;  ///< of each shape
  /// [i][j]: fronts of j met by rays of i, first of all or behind something.
  std::vector<std::vector<std::uint64_t>> visible, blocked;
  std::uint64_t escaped = 0, met_back = 0;

  /// No ray left the scene or saw the back of a surface, up to the few that slip through between neighbours.
  [[nodiscard]] bool closed() const;
};

/// Cosine-distributed rays from the front of each shape, stratified over the shape and over the hemisphere.
/// The same counts on any number of threads. Without `beyond_first`, `blocked` stays zero.
ShapeRayCounts count_shape_rays(const Scene& scene, const ShapeFronts& fronts, std::uint32_t rays,
                                bool beyond_first, std::uint32_t seed);

}  // namespace twopass
