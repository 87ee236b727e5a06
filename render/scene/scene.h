// What there is to see: the description that loaders fill in, and the scene built from it. Knows no algorithm.
#pragma once

#include <string>
#include <vector>

#include "render/scene/camera.h"
#include "render/scene/environment.h"
#include "render/scene/geometry.h"
#include "render/scene/lights.h"
#include "render/scene/punctual_light.h"
#include "render/scene/ray_caster.h"
#include "render/scene/shape.h"
#include "render/scene/world_frame.h"

namespace twopass {

struct Parametrization;

/// Plain data, as loaders leave it: every index in range, every number finite.
struct SceneDescription {
  std::vector<Shape> shapes;
  std::vector<Material> materials;  ///< at least one when there are shapes
  std::optional<CameraDescription> camera;
  std::vector<PunctualLight> punctual_lights;
  Environment environment;  ///< what is seen in directions in which nothing is hit
  /// Light groups of punctual lights, in their order; "" and missing ones are "default".
  std::vector<std::string> punctual_light_groups{};
  std::string environment_light_group = "environment";
  WorldFrame frame{};  ///< where all of this stands in the file's coordinates
};

/// Puts all colours of a scene, which are linear Rec.709, into other primaries: of materials, lights and
/// surroundings. Rendering then multiplies, and the picture holds, colours of those.
void put_in_primaries(SceneDescription& scene, const ColorMatrix& primaries);

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
  [[nodiscard]] std::span<const PunctualLight> punctual_lights() const { return description_.punctual_lights; }
  [[nodiscard]] const Environment& environment() const { return description_.environment; }
  [[nodiscard]] const Box3f& bounds() const { return bounds_; }

  /// What the ray hit. REQUIRES: !hit.escaped(). Inline, below: every vertex of every path calls it.
  [[nodiscard]] SurfacePoint surface_point(const Ray& ray, const Hit& hit) const;
  /// Has the processor fetch what surface_point() will read, where it may not have it at hand. Hits may be
  /// escaped.
  void prefetch(std::span<const Hit> hits) const;
  /// The material on the side that the viewer sees.
  [[nodiscard]] const MaterialSide& side(const SurfacePoint& point) const {
    return *surfaces_[point.shape].side[point.side];
  }
  /// The scattering model at the point: the side's own where it is uniform, else resolved into `storage`, for
  /// which the point's shading frame may be turned. `direction`: of the ray that arrived. `choose()` in [0, 1)
  /// is called only by mixtures.
  template <class Choose>
  const Bsdf& resolve(SurfacePoint& point, const V3f& direction, Bsdf& storage, Choose&& choose) const {
    const MaterialSide& material = side(point);
    if (material.is_uniform()) return material.uniform();
    resolve_at(material, point, direction, material.traits().needs_choice ? choose() : 0.0f, storage);
    return storage;
  }
  /// Texture coordinates of a point, whether its material looks at them or not.
  [[nodiscard]] V2f texture_coordinates(const SurfacePoint& point) const;
  /// Radiance that the point emits towards the viewer, W/(m2 sr).
  [[nodiscard]] C3f emitted_radiance(const SurfacePoint& point) const {
    if (!surfaces_[point.shape].emits[point.side]) return C3f(0.0f);
    const Shape& shape = description_.shapes[point.shape];
    if (shape.radiance_texture && point.side == front) return color_at(*shape.radiance_texture, point.where());
    return shape.radiance[point.side];
  }
  /// The share of light that passes along the open segment, in [0, 1]: through masks, where there are some.
  /// REQUIRES: both ends are clear of their own surfaces.
  [[nodiscard]] float transmittance(const Segment& segment) const;
  /// Whether light passes straight through some surfaces: shadow rays must look at what they meet.
  [[nodiscard]] bool has_see_through() const { return has_see_through_; }
  /// Whether materials vary over surfaces: then a beam sees more than a ray.
  [[nodiscard]] bool has_textures() const { return has_textures_; }

 private:
  // What every vertex on a triangle needs and would else be computed again each time: 28 bytes a triangle.
  struct Face {
    V3f normal;       // unit, of the front
    float offset;     // SurfacePoint::offset
    float near_edge;  // see geometry.h
    V2f uv_rate;      // SurfacePoint::uv_rate, in the mesh's own coordinates
  };
  // What every vertex reads of the shape that it is on, in one line of the cache. Pointers are null where there
  // is nothing of the kind; arrays of an instance are in its own coordinates.
  struct alignas(64) Surface {
    const V3u* triangles;
    const V3f* positions;
    const V3f* normals;
    const V2f* uvs;
    const Face* faces;
    std::array<const MaterialSide*, 2> side;
    std::array<bool, 2> emits, needs_uv, needs_tangents;
    bool is_mesh;
  };
  void find_faces();
  void find_surfaces();
  // The point of an analytic surface or an instance, and its normals, of the front.
  void place(SurfacePoint& point, const Ray& ray, const Hit& hit, V3f& normal, V3f& shading_normal) const;
  // The interpolated normal of a triangle's front; `normal`, the true one, if there is none.
  static V3f shading_normal_of(const Surface& surface, const Hit& hit, const V3f& normal) {
    if (!surface.normals) return normal;
    const V3u& index = surface.triangles[hit.primitive];
    const V3f* normals = surface.normals;
    const V3f n =
        normals[index.x] * (1.0f - hit.u - hit.v) + normals[index.y] * hit.u + normals[index.z] * hit.v;
    const V3f shading_normal = n.dot(n) > 0.0f ? unit(n) : normal;
    // Normals that disagree with the winding by more than a right angle mean the same side, written inside out.
    return shading_normal.dot(normal) < 0.0f ? -shading_normal : shading_normal;
  }
  static void resolve_at(const MaterialSide& material, SurfacePoint& point, const V3f& direction, float u,
                         Bsdf& bsdf);
  // `normal`: of the front.
  [[nodiscard]] Parametrization parametrization_at(const SurfacePoint& point, const V3f& normal) const;
  // Texture coordinates, tangents and a frame along them. `normal` is that of the front.
  void add_parametrization(SurfacePoint& point, const V3f& normal) const;

  SceneDescription description_;
  std::vector<std::vector<Face>> face_lists_;  // one a mesh, however many instances it has
  std::vector<Surface> surfaces_;              // by shape
  Box3f bounds_;
  RayCaster caster_;
  Lights lights_;
  bool has_see_through_, has_textures_, is_large_ = false;
};

inline SurfacePoint Scene::surface_point(const Ray& ray, const Hit& hit) const {
  SurfacePoint point;
  point.shape = hit.shape;
  point.primitive = hit.primitive;
  point.u = hit.u;
  point.v = hit.v;
  const Surface& surface = surfaces_[hit.shape];
  V3f normal, shading_normal;  // of the front
  if (surface.is_mesh) {
    const V3u& index = surface.triangles[hit.primitive];
    const std::array<V3f, 3> p{surface.positions[index.x], surface.positions[index.y],
                               surface.positions[index.z]};
    const float w = 1.0f - hit.u - hit.v;
    point.position = p[0] * w + p[1] * hit.u + p[2] * hit.v;
    const Face& face = surface.faces[hit.primitive];
    normal = face.normal;
    point.offset = face.offset;
    if (std::min({w, hit.u, hit.v}) < face.near_edge) [[unlikely]]
      point.position = clear_of_edges(point.position, p, normal, {w, hit.u, hit.v}, face.offset);
    shading_normal = shading_normal_of(surface, hit, normal);
  } else {
    place(point, ray, hit, normal, shading_normal);
  }
  point.side = normal.dot(ray.direction) < 0.0f ? front : back;
  point.geometric_normal = point.side == front ? normal : -normal;
  if (point.side == back) shading_normal = -shading_normal;
  // A viewer below the shading horizon would see a black rim: there the geometric normal shades.
  if (shading_normal.dot(ray.direction) >= 0.0f) shading_normal = point.geometric_normal;
  point.shading = Frame(shading_normal);
  if (surface.needs_uv[point.side]) add_parametrization(point, normal);
  return point;
}

}  // namespace twopass
