// Gathering the light of diffuse surfaces at points of elements, by rays: what an indirect field is made of.
#pragma once

#include <utility>

#include "radiosity/element_response.h"
#include "radiosity/indirect_field.h"
#include "radiosity/landing.h"
#include "render/scene/scene.h"

namespace twopass {

/// Brightness of light, by which errors are judged: its largest channel.
inline double brightness(const C3d& c) { return std::max(std::max(c.x, c.y), c.z); }

/// A flat triangle between vertices: an element, or a part of one.
struct FieldCell {
  std::uint32_t face;  ///< the element
  std::array<std::uint32_t, 3> corner;
};

/// What the rays from one place found: sums over those that did not start buried.
struct Gathered {
  std::uint32_t rays = 0, buried = 0;
  C3d irradiance{0.0};
  C3d nearby{0.0};  // of the irradiance: from elements that are nearer than they resolve
  std::array<C3d, 3> across{C3d(0.0), C3d(0.0), C3d(0.0)};  // net irradiance along the surface, by axis
  double brightness2 = 0.0;                                 // squared brightness of each ray
  double inverse_distance = 0.0;                            // of what they met
  C3d caustic{0.0};  // of the irradiance: light straight from lamps over specular surfaces

  // Rays find caustics by chance: what is more than a trace of them is left to gather rays, which are many.
  [[nodiscard]] bool sees_caustic(double direct) const {
    constexpr double trace = 0.02;
    return brightness(caustic) > trace * (direct * rays + brightness(irradiance));
  }
  [[nodiscard]] C3d mean_across(std::size_t axis) const {
    return rays == 0 ? C3d(0.0) : across[axis] / static_cast<double>(rays);
  }
  [[nodiscard]] C3d mean() const { return rays == 0 ? C3d(0.0) : irradiance / static_cast<double>(rays); }
  // Standard error of the mean's brightness, as if the rays were independent: stratified ones are better.
  [[nodiscard]] double noise() const {
    if (rays == 0) return 0.0;
    const double n = rays, b = brightness(mean());
    return std::sqrt(std::max(0.0, brightness2 / n - b * b) / n);
  }
};

/// What lies between two places, `t` of the way from the first.
Gathered between(const Gathered& a, const Gathered& b, double t);

/// The cells around each vertex.
class Fans {
 public:
  Fans(std::span<const FieldCell> cells, std::size_t vertices);
  /// Each with the number of its corner there.
  [[nodiscard]] std::span<const std::pair<std::uint32_t, std::uint32_t>> of(std::uint32_t vertex) const {
    return {corner_.data() + first_[vertex], corner_.data() + first_[vertex + 1]};
  }

 private:
  std::vector<std::uint32_t> first_;                             // by vertex, and the end
  std::vector<std::pair<std::uint32_t, std::uint32_t>> corner_;  // cell and which of its corners
};

/// Const and thread-safe; `rays` is increased by the number of rays cast.
class Gathering {
 public:
  /// REQUIRES: all of them outlive it; vertices may be added to `position`.
  Gathering(const Scene& scene, const Solution& solution, const std::vector<V3d>& position,
            const IndirectFieldOptions& options);

  /// (R39): rays from around a vertex, out of the cells that touch it, until their noise is small against all
  /// the light there, of which `direct` is known, or there are `most_rays`; the smaller, the more there may be
  /// (R55).
  [[nodiscard]] Gathered at(std::uint32_t vertex, std::span<const FieldCell> cells, const Fans& fans,
                            double direct, std::uint32_t most_rays, std::uint64_t& rays) const;
  /// The same from the inner quarter of a cell: of what is linear on it, the mean over its corners. `key`
  /// distinguishes it from others.
  [[nodiscard]] Gathered in_the_middle(const FieldCell& cell, std::uint32_t key, double direct,
                                       std::uint64_t& rays) const;
  /// Whether something stands across the cell, a wall between its corners: then light is different on both
  /// sides, however alike it is at the corners.
  [[nodiscard]] bool is_crossed(const FieldCell& cell, std::uint64_t& rays) const;
  [[nodiscard]] std::array<V3d, 3> corners(const FieldCell& cell) const {
    return {position_[cell.corner[0]], position_[cell.corner[1]], position_[cell.corner[2]]};
  }

 private:
  struct Start;
  template <class AddRay>
  [[nodiscard]] Gathered gather(double noise, double direct, std::uint32_t most_rays,
                                const AddRay& add_ray) const;
  [[nodiscard]] bool can_gather_at(std::uint32_t face) const;
  [[nodiscard]] Start start(std::uint32_t face, const std::array<V3d, 3>& part, float reach) const;
  [[nodiscard]] C3d diffused(const Ray& ray, const Landing& landing) const;
  void add_ray(const Start& from, Sampler& sampler, Gathered& sum, std::uint64_t& rays) const;
  [[nodiscard]] C3d over_specular(const Ray& ray, const Landing& landing, Sampler& sampler, C3d& caustic,
                                  std::uint64_t& rays) const;

  const Scene& scene_;
  const ElementMesh& mesh_;
  const std::vector<V3d>& position_;
  const IndirectFieldOptions& options_;
  ElementRays element_rays_;
  ElementResponse response_;
  std::vector<C3d> radiosity_;  // reflected, by element
};

}  // namespace twopass
