#include "render/scene/scene.h"

#include <algorithm>
#include <type_traits>
#include <unordered_map>

#include "render/scene/parametrization.h"

namespace twopass {

namespace {

Box3f box_of_positions(const Mesh& mesh) {
  Box3f box;
  for (const V3f& p : mesh.positions) box.extendBy(p);
  return box;
}

// The box around the placed box around the mesh, whose own is found once.
class InstanceBoxes {
 public:
  Box3f operator()(const MeshInstance& instance) {
    const auto [entry, is_new] = known_.try_emplace(instance.mesh.get());
    if (is_new) entry->second = box_of_positions(*instance.mesh);
    const Box3f& local = entry->second;
    Box3f box;
    if (local.isEmpty()) return box;
    for (int corner = 0; corner < 8; ++corner)
      box.extendBy(instance.to_world.point(V3f((corner & 1 ? local.max : local.min).x,
                                               (corner & 2 ? local.max : local.min).y,
                                               (corner & 4 ? local.max : local.min).z)));
    return box;
  }

 private:
  std::unordered_map<const Mesh*, Box3f> known_;
};

}  // namespace

void put_in_primaries(SceneDescription& scene, const ColorMatrix& primaries) {
  for (Material& material : scene.materials) material = in_primaries(material, primaries);
  for (Shape& shape : scene.shapes) {
    for (C3f& radiance : shape.radiance) radiance = primaries(radiance);
    if (shape.radiance_texture)
      shape.radiance_texture =
          std::make_shared<const Texture>(in_primaries(*shape.radiance_texture, primaries));
  }
  for (PunctualLight& light : scene.punctual_lights) light = in_primaries(std::move(light), primaries);
  scene.environment = scene.environment.in_primaries(primaries);
}

Box3f bounds_of(std::span<const Shape> shapes) {
  Box3f bounds;
  InstanceBoxes box_of_instance;
  for (const Shape& shape : shapes)
    bounds.extendBy(std::visit(
        [&]<class Kind>(const Kind& kind) {
          if constexpr (std::is_same_v<Kind, Mesh>)
            return box_of_positions(kind);
          else if constexpr (std::is_same_v<Kind, MeshInstance>)
            return box_of_instance(kind);
          else
            return box_of(kind);
        },
        shape.geometry));
  return bounds;
}

void Scene::find_faces() {
  std::unordered_map<const Mesh*, std::size_t> known;
  std::vector<std::size_t> list;  // by shape
  std::size_t triangles = 0;
  for (const Shape& shape : shapes()) {
    const Mesh* mesh = mesh_of(shape.geometry);
    const auto [entry, is_new] = known.try_emplace(mesh, face_lists_.size());
    list.push_back(entry->second);
    if (!is_new) continue;
    if (mesh) triangles += mesh->triangles.size();
    std::vector<Face>& faces = face_lists_.emplace_back();
    for (std::uint32_t i = 0; mesh && i < mesh->triangles.size(); ++i) {
      const auto p = corners(*mesh, i);
      const float offset = rounding_offset(p);
      const V3f normal = unit((p[1] - p[0]).cross(p[2] - p[0]));
      faces.push_back(
          {normal, offset, near_edge(p, offset), rate_of(parametrization(*mesh, i, V2f(0.0f), normal))});
    }
  }
  for (std::size_t s = 0; s < list.size(); ++s) surfaces_[s].faces = face_lists_[list[s]].data();
  // A triangle and its corners take about a hundred bytes: fewer are in the nearer caches anyway.
  constexpr std::size_t at_hand = 10000;
  is_large_ = triangles > at_hand;
}

void Scene::find_surfaces() {
  const auto data_of = [](const auto& list) { return list.empty() ? nullptr : list.data(); };
  for (const Shape& shape : shapes()) {
    Surface& surface = surfaces_.emplace_back();
    surface.is_mesh = std::holds_alternative<Mesh>(shape.geometry);
    if (const Mesh* mesh = mesh_of(shape.geometry)) {
      surface.triangles = data_of(mesh->triangles);
      surface.positions = data_of(mesh->positions);
      surface.normals = data_of(mesh->normals);
      surface.uvs = data_of(mesh->uvs);
    }
    for (const Side side : {front, back}) {
      const MaterialSide& material = description_.materials[shape.material].side[side];
      surface.side[side] = &material;
      surface.emits[side] = !is_black(shape.radiance[side]);
      surface.needs_tangents[side] = material.traits().needs_tangents;
      surface.needs_uv[side] = material.traits().needs_uv || shape.radiance_texture;
    }
  }
}

void Scene::prefetch(std::span<const Hit> hits) const {
  if (!is_large_) return;
  for (const Hit& hit : hits) {
    if (hit.escaped() || !surfaces_[hit.shape].triangles) continue;
    __builtin_prefetch(surfaces_[hit.shape].triangles + hit.primitive);
    __builtin_prefetch(surfaces_[hit.shape].faces + hit.primitive);
  }
  for (const Hit& hit : hits) {
    if (hit.escaped() || !surfaces_[hit.shape].triangles) continue;
    const Surface& surface = surfaces_[hit.shape];
    const V3u& index = surface.triangles[hit.primitive];
    for (const std::uint32_t i : {index.x, index.y, index.z}) {
      __builtin_prefetch(surface.positions + i);
      if (surface.normals) __builtin_prefetch(surface.normals + i);
      if (surface.uvs && surface.needs_uv[front]) __builtin_prefetch(surface.uvs + i);
    }
  }
}

void Scene::place(SurfacePoint& point, const Ray& ray, const Hit& hit, V3f& normal, V3f& shading_normal) const {
  const Geometry& geometry = description_.shapes[hit.shape].geometry;
  const V3f met = ray.origin + ray.direction * hit.t;
  if (const auto* instance = std::get_if<MeshInstance>(&geometry)) {
    const auto p = corners(*instance->mesh, hit.primitive);
    const Surface& surface = surfaces_[hit.shape];
    const Face& face = surface.faces[hit.primitive];
    const Placement& to_world = instance->to_world;
    const float w = 1.0f - hit.u - hit.v;
    V3f local = p[0] * w + p[1] * hit.u + p[2] * hit.v;
    if (std::min({w, hit.u, hit.v}) < face.near_edge)
      local = clear_of_edges(local, p, face.normal, {w, hit.u, hit.v}, face.offset);
    point.position = to_world.point(local);
    point.offset = rounding_offset(to_world, point.position, face.offset);
    normal = unit(to_world.normal(face.normal));
    shading_normal = unit(to_world.normal(shading_normal_of(surface, hit, face.normal)));
    return;
  }
  if (const auto* sphere = std::get_if<Sphere>(&geometry)) {
    const V3f outward = unit(met - sphere->center);
    point.position = sphere->center + outward * sphere->radius;
    point.offset = rounding_offset(*sphere);
    normal = sphere->inward ? -outward : outward;
  } else if (const auto* disk = std::get_if<Disk>(&geometry)) {
    double t = 0.0;
    V2d at(0.0, 0.0);
    // Again in double: the plane holds the point to its own rounding, however far the ray came.
    intersect_disk(*disk, ray.origin, ray.direction, t, at);
    point.position = disk->center + disk->x * static_cast<float>(at.x) + disk->y * static_cast<float>(at.y);
    point.offset = rounding_offset(*disk);
    normal = unit_normal(*disk);
  } else {
    const auto& cylinder = std::get<Cylinder>(geometry);
    float along;
    const V3f outward = outward_at(cylinder, met, along);
    point.position = cylinder.base + cylinder.axes[2] * (along * cylinder.length) + outward * cylinder.radius;
    point.offset = rounding_offset(cylinder);
    normal = cylinder.inward ? -outward : outward;
  }
  shading_normal = normal;
}

Scene::Scene(SceneDescription description)
    : description_(std::move(description)),
      bounds_(bounds_of(description_.shapes)),
      caster_(description_.shapes),
      lights_(description_.shapes, description_.punctual_lights, description_.environment, bounds_),
      has_see_through_(std::ranges::any_of(description_.shapes,
                                           [this](const Shape& shape) {
                                             const Material& material = description_.materials[shape.material];
                                             return material.side[front].traits().is_see_through ||
                                                    material.side[back].traits().is_see_through;
                                           })),
      has_textures_(std::ranges::any_of(description_.materials, [](const Material& material) {
        return !material.side[front].is_uniform() || !material.side[back].is_uniform();
      })) {
  find_surfaces();
  find_faces();
}

Parametrization Scene::parametrization_at(const SurfacePoint& point, const V3f& normal) const {
  const Surface& surface = surfaces_[point.shape];
  const Shape& shape = description_.shapes[point.shape];
  if (surface.is_mesh && surface.uvs) {
    const V3u& index = surface.triangles[point.primitive];
    const V3f* positions = surface.positions;
    return parametrization({positions[index.x], positions[index.y], positions[index.z]},
                           {surface.uvs[index.x], surface.uvs[index.y], surface.uvs[index.z]},
                           {point.u, point.v}, normal);
  }
  if (surface.is_mesh) return any_parametrization({point.u, point.v}, normal);
  if (const auto* instance = std::get_if<MeshInstance>(&shape.geometry)) {
    const Face& face = surface.faces[point.primitive];
    Parametrization p = parametrization(*instance->mesh, point.primitive, {point.u, point.v}, face.normal);
    p.dp_du = instance->to_world.vector(p.dp_du);
    p.dp_dv = instance->to_world.vector(p.dp_dv);
    return p;
  }
  if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) return parametrization(*sphere, normal);
  if (const auto* disk = std::get_if<Disk>(&shape.geometry)) return parametrization(*disk, point.position);
  return parametrization(std::get<Cylinder>(shape.geometry), point.position);
}

V2f Scene::texture_coordinates(const SurfacePoint& point) const {
  const V3f& normal = point.geometric_normal;
  return parametrization_at(point, point.side == front ? normal : -normal).uv;
}

void Scene::add_parametrization(SurfacePoint& point, const V3f& normal) const {
  const Surface& surface = surfaces_[point.shape];
  if (surface.is_mesh && surface.uvs && !surface.needs_tangents[point.side]) {
    const V3u& index = surface.triangles[point.primitive];
    point.uv =
        interpolated({surface.uvs[index.x], surface.uvs[index.y], surface.uvs[index.z]}, {point.u, point.v});
    point.uv_rate = surface.faces[point.primitive].uv_rate;
    return;
  }
  const Parametrization p = parametrization_at(point, normal);
  point.uv = p.uv;
  point.uv_rate = rate_of(p);
  if (!surface.needs_tangents[point.side]) return;
  point.dp_du = p.dp_du;
  point.dp_dv = p.dp_dv;
  const V3f& n = point.shading.n;
  const V3f s = p.dp_du - n * n.dot(p.dp_du);
  if (!(s.dot(s) > 0.0f) || !is_finite(s)) return;  // seen along the tangent: any frame will do
  point.shading.s = unit(s);
  point.shading.t = n.cross(point.shading.s);
}

float Scene::transmittance(const Segment& segment) const {
  float share = 1.0f;
  V3f from = segment.from;
  // Sheets as near as rounding could hold a ray forever.
  constexpr int most_sheets = 1000;
  for (int sheet = 0; sheet < most_sheets && caster_.occluded(from, segment.to); ++sheet) {
    const V3f to_end = segment.to - from;
    const Ray ray{from, unit(to_end)};
    const Hit hit = caster_.intersect(ray);
    if (hit.escaped() || hit.t * hit.t >= to_end.dot(to_end)) return share;  // rounding: the queries disagree
    const SurfacePoint point = surface_point(ray, hit);
    share *= side(point).transparency(point.where());
    if (share == 0.0f) return 0.0f;
    from = spawn_position(point, ray.direction);
  }
  return share;
}

void Scene::resolve_at(const MaterialSide& material, SurfacePoint& point, const V3f& direction, float u,
                       Bsdf& bsdf) {
  TexturePoint where = point.where();
  // (M31), along the narrow side of the beam's ellipse on the surface.
  if (point.beam_width > 0.0f) where.footprint = point.uv_rate * point.beam_width;
  point.terminator = 0.0f;
  point.unperturbed_normal = point.shading.n;
  if (material.is_single_model()) return material.resolve(where, bsdf);
  ShadingGeometry at{.uv = where.uv,
                     .dp_du = point.dp_du,
                     .dp_dv = point.dp_dv,
                     .wo = -direction,
                     .frame = point.shading,
                     .is_back = point.side == back,
                     .footprint = where.footprint,
                     .place = where.place};
  material.resolve(at, u, bsdf);
  point.terminator = at.terminator;
  point.shading = at.frame;
}

}  // namespace twopass
