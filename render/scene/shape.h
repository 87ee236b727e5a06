// Shapes as plain data, in world space.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "materials/material.h"
#include "render/core/types.h"

namespace twopass {

/// A triangle mesh. The front of a triangle is the side from which its corners run counter-clockwise.
struct Mesh {
  std::vector<V3f> positions;
  std::vector<V3f> normals;    ///< shading normals, unit, one a position; or empty: faceted
  std::vector<V2f> uvs;        ///< texture coordinates, one a position; or empty
  std::vector<V3u> triangles;  ///< indices into the arrays above; all in range
};

/// An analytic sphere; its front is the outside unless `inward`.
struct Sphere {
  V3f center{0.0f};
  float radius = 1.0f;
  bool inward = false;
  /// Directions of its own x, y and z axes in the world, unit: where texture coordinates start. u runs around z
  /// from x (0) to y (1/4) to x (1), v from z (0) to -z (1).
  std::array<V3f, 3> axes{V3f(1, 0, 0), V3f(0, 1, 0), V3f(0, 0, 1)};
};

/// One thing in the scene, of one material.
struct Shape {
  std::string name;  ///< object, group or id; what form-factor tables and errors call it
  std::variant<Mesh, Sphere> geometry;
  std::uint32_t material = 0;                         ///< index into SceneDescription::materials
  std::array<C3f, 2> radiance{C3f(0.0f), C3f(0.0f)};  ///< emitted by the front and the back, W/(m2 sr)
  /// What the front emits where that varies: then radiance[front] is its mean.
  std::shared_ptr<const Texture> radiance_texture{};
};

inline bool is_emitter(const Shape& shape) {
  return !is_black(shape.radiance[front]) || !is_black(shape.radiance[back]);
}

}  // namespace twopass
