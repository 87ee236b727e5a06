// Shapes as plain data, in world space.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "materials/material.h"
#include "render/core/types.h"

namespace twopass {

/// Data of a mesh for textures: a colour at every position or on every triangle.
struct MeshAttribute {
  std::string name;         ///< "vertex_..." or "face_..."
  std::vector<C3f> values;  ///< one a position or triangle
  [[nodiscard]] bool is_of_faces() const { return name.starts_with("face_"); }
};

/// A triangle mesh. The front of a triangle is the side from which its corners run counter-clockwise.
struct Mesh {
  std::vector<V3f> positions;
  std::vector<V3f> normals;                 ///< shading normals, unit, one a position; or empty: faceted
  std::vector<V2f> uvs;                     ///< texture coordinates, one a position; or empty
  std::vector<V3u> triangles;               ///< indices into the arrays above; all in range
  std::vector<MeshAttribute> attributes{};  ///< further data, as its file names them
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

/// An analytic disk, or an ellipse: center + a x + b y for a^2 + b^2 <= 1. Its front is the side from which x
/// turns counter-clockwise to y, unless `reversed`. Texture coordinates: u is the radius sqrt(a^2 + b^2), v
/// runs around from x (0) over y (1/4) to x (1).
struct Disk {
  V3f center{0.0f};
  V3f x{1.0f, 0.0f, 0.0f}, y{0.0f, 1.0f, 0.0f};  ///< not parallel; a circle: perpendicular, a radius long
  bool reversed = false;
};

/// An analytic cylinder without caps; its front is the outside unless `inward`. Texture coordinates: u runs
/// around z from x (0) over y (1/4) to x (1), v along z from the base to the other end.
struct Cylinder {
  V3f base{0.0f};  ///< centre of one end
  float radius = 1.0f, length = 1.0f;
  bool inward = false;
  std::array<V3f, 3> axes{V3f(1, 0, 0), V3f(0, 1, 0), V3f(0, 0, 1)};  ///< unit, perpendicular
};

/// Where a copy of something stands: p goes to x p.x + y p.y + z p.z + origin. Turns no right hand into a left
/// one: mirror images are made of mirrored meshes.
struct Placement {
  V3f x{1.0f, 0.0f, 0.0f}, y{0.0f, 1.0f, 0.0f}, z{0.0f, 0.0f, 1.0f}, origin{0.0f};

  [[nodiscard]] V3f vector(const V3f& v) const { return x * v.x + y * v.y + z * v.z; }
  [[nodiscard]] V3f point(const V3f& p) const { return vector(p) + origin; }
  /// A multiple of the normal that belongs to `n`, by the inverse transpose; > 0 times it.
  [[nodiscard]] V3f normal(const V3f& n) const {
    return y.cross(z) * n.x + z.cross(x) * n.y + x.cross(y) * n.z;
  }
  bool operator==(const Placement&) const = default;
};

/// A mesh that stands in several places and is stored once, with one acceleration structure.
struct MeshInstance {
  std::shared_ptr<const Mesh> mesh;  ///< in its own coordinates
  Placement to_world;
};

using Geometry = std::variant<Mesh, Sphere, Disk, Cylinder, MeshInstance>;

/// One thing in the scene, of one material.
struct Shape {
  std::string name;  ///< object, group or id; what form-factor tables and errors call it
  Geometry geometry;
  std::uint32_t material = 0;                         ///< index into SceneDescription::materials
  std::array<C3f, 2> radiance{C3f(0.0f), C3f(0.0f)};  ///< emitted by the front and the back, W/(m2 sr)
  /// What the front emits where that varies: then radiance[front] is its mean.
  std::shared_ptr<const Texture> radiance_texture{};
  std::optional<std::string> light_group{};  ///< of its light; "": "default"; unset: called like the shape
};

inline bool is_emitter(const Shape& shape) {
  return !is_black(shape.radiance[front]) || !is_black(shape.radiance[back]);
}

}  // namespace twopass
