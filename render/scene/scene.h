// What there is to see: the description that loaders fill in, and the scene built from it. Knows no algorithm.
#pragma once

#include <string>
#include <vector>

#include "render/scene/camera.h"
#include "render/scene/lights.h"
#include "render/scene/ray_caster.h"
#include "render/scene/shape.h"

namespace twopass {

/// Plain data, as loaders leave it: every index in range, every number finite.
struct SceneDescription {
  std::vector<Shape> shapes;
  std::vector<Material> materials;  ///< at least one when there are shapes
  std::optional<CameraDescription> camera;
  C3f sky{0.0f};  ///< constant radiance of directions in which nothing is hit
};

/// The smallest box around all shapes; empty without any.
Box3f bounds_of(std::span<const Shape> shapes);

/// A scene ready for rays. Const once built, so it needs no locks.
class Scene {
 public:
  /// Builds the acceleration structure and the lights.
  explicit Scene(SceneDescription description);

  [[nodiscard]] const SceneDescription& description() const { return description_; }
  [[nodiscard]] std::span<const Shape> shapes() const { return description_.shapes; }
  [[nodiscard]] const RayCaster& caster() const { return caster_; }
  [[nodiscard]] const Lights& lights() const { return lights_; }
  [[nodiscard]] const C3f& sky() const { return description_.sky; }
  [[nodiscard]] const Box3f& bounds() const { return bounds_; }

  /// What the ray hit. REQUIRES: !hit.escaped().
  [[nodiscard]] SurfacePoint surface_point(const Ray& ray, const Hit& hit) const;
  /// The scattering model on the side that the viewer sees.
  [[nodiscard]] const Bsdf& bsdf(const SurfacePoint& point) const {
    return description_.materials[description_.shapes[point.shape].material].side[point.side];
  }
  /// Radiance that the point emits towards the viewer, W/(m2 sr).
  [[nodiscard]] const C3f& emitted_radiance(const SurfacePoint& point) const {
    return description_.shapes[point.shape].radiance[point.side];
  }

 private:
  SceneDescription description_;
  Box3f bounds_;
  RayCaster caster_;
  Lights lights_;
};

}  // namespace twopass
