#include "render/scene/scene.h"

#include <algorithm>

#include "render/scene/parametrization.h"

namespace twopass {

Box3f bounds_of(std::span<const Shape> shapes) {
  Box3f box;
  for (const Shape& shape : shapes) {
    if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) {
      for (const V3f& p : mesh->positions) box.extendBy(p);
    } else {
      const Sphere& sphere = std::get<Sphere>(shape.geometry);
      box.extendBy(sphere.center - V3f(sphere.radius));
      box.extendBy(sphere.center + V3f(sphere.radius));
    }
  }
  return box;
}

std::vector<std::vector<Scene::Face>> Scene::faces_of(std::span<const Shape> shapes) {
  std::vector<std::vector<Face>> faces(shapes.size());
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    const auto* mesh = std::get_if<Mesh>(&shapes[s].geometry);
    if (!mesh) continue;
    faces[s].resize(mesh->triangles.size());
    for (std::uint32_t i = 0; i < mesh->triangles.size(); ++i) {
      const auto p = corners(*mesh, i);
      faces[s][i] = {unit((p[1] - p[0]).cross(p[2] - p[0])), rounding_offset(p)};
    }
  }
  return faces;
}

Scene::Scene(SceneDescription description)
    : description_(std::move(description)),
      faces_(faces_of(description_.shapes)),
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
      })) {}

void Scene::add_parametrization(SurfacePoint& point, const Shape& shape, const V3f& normal) const {
  Parametrization p;
  if (const auto* mesh = std::get_if<Mesh>(&shape.geometry))
    p = parametrization(*mesh, point.primitive, {point.u, point.v}, normal);
  else
    p = parametrization(std::get<Sphere>(shape.geometry), normal);
  point.uv = p.uv;
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
    share *= side(point).transparency(point.uv);
    if (share == 0.0f) return 0.0f;
    from = spawn_position(point, ray.direction);
  }
  return share;
}

Bsdf Scene::resolve_at(const MaterialSide& material, SurfacePoint& point, const V3f& direction, float u) {
  ShadingGeometry at{.uv = point.uv,
                     .dp_du = point.dp_du,
                     .dp_dv = point.dp_dv,
                     .wo = -direction,
                     .frame = point.shading,
                     .is_back = point.side == back};
  // (M31), along the narrow side of the beam's ellipse on the surface.
  if (point.beam_width > 0.0f)
    at.footprint = {point.beam_width / point.dp_du.length(), point.beam_width / point.dp_dv.length()};
  const Bsdf bsdf = material.resolve(at, u);
  point.terminator = at.terminator;
  point.unperturbed_normal = point.shading.n;
  point.shading = at.frame;
  return bsdf;
}

}  // namespace twopass
