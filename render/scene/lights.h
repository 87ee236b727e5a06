// Sampling points on the emitting shapes, for next-event estimation.
#pragma once

#include <span>
#include <vector>

#include "render/core/distribution.h"
#include "render/scene/ray.h"
#include "render/scene/shape.h"

namespace twopass {

/// A point of a light as seen from a receiver.
struct LightSample {
  V3f position;   ///< clear of the light's own surface: a shadow ray may end here
  V3f direction;  ///< unit, from the receiver to the light
  C3f radiance;   ///< towards the receiver
  float pdf_w;    ///< density of the direction in solid angle at the receiver; 0: nothing to be had
};

/// All emitting triangles and spheres, chosen in proportion to their power. Triangles are sampled uniformly in
/// area, spheres uniformly in the solid angle that they fill.
class Lights {
 public:
  /// REQUIRES: the shapes outlive the lights.
  explicit Lights(std::span<const Shape> shapes);

  [[nodiscard]] bool empty() const { return choice_.empty(); }
  /// Number of emitting triangles and spheres.
  [[nodiscard]] std::size_t count() const { return entries_.size(); }
  /// REQUIRES: !empty().
  [[nodiscard]] LightSample sample(const V3f& receiver, const V2f& u) const;
  /// The density with which sample(receiver) would choose the direction of `point`, seen at the given distance.
  /// 0 for points that do not emit towards the receiver.
  [[nodiscard]] float pdf_w(const V3f& receiver, const V3f& direction, float distance,
                            const SurfacePoint& point) const;

 private:
  struct Entry {
    std::uint32_t shape;
    float pdf_a;  ///< of choosing this entry and a point of it
    float offset;
    V3f corner, edge1, edge2, normal;  // of a triangle's front; unused for a sphere
  };
  std::span<const Shape> shapes_;
  std::vector<Entry> entries_;
  std::vector<std::uint32_t> first_entry_;  // by shape; no_index where it does not emit
  DiscreteDistribution choice_;
};

}  // namespace twopass
