// Ray casting: nothing else knows Embree (3 or 4).
#pragma once

#include <memory>
#include <span>

#include "render/scene/ray.h"
#include "render/scene/shape.h"

namespace twopass {

/// What the caller knows of rays that it casts together; it decides on the time that they take. What they hit
/// is the same but for ties: of two triangles at the same distance either may win.
enum class Rays {
  coherent,  ///< they start and point alike, as camera rays do
  scattered  ///< they do not
};

/// An acceleration structure over shapes. Const and thread-safe once built.
class RayCaster {
 public:
  /// Meshes that instances share are stored once. REQUIRES: the shapes outlive the caster (analytic ones are
  /// read from them); meshes valid and finite.
  /// Throws Error when Embree cannot build.
  explicit RayCaster(std::span<const Shape> shapes);
  ~RayCaster();
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  /// Nearest hit along the ray. A non-finite or out-of-range ray hits nothing.
  [[nodiscard]] Hit intersect(const Ray& ray) const;
  /// Whether anything lies on the open segment between two points. Both must already be clear of their own
  /// surfaces. True for non-finite points.
  [[nodiscard]] bool occluded(const V3f& from, const V3f& to) const;

  /// The same for many, in packets (I7). REQUIRES: as many results as queries, or more.
  void intersect(std::span<const Ray> rays, std::span<Hit> hits, Rays kind) const;
  void occluded(std::span<const Segment> segments, std::span<bool> results) const;

  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace twopass
