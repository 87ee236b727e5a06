#include "render/scene/scene.h"

#include <algorithm>

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
      lights_(description_.shapes),
      has_see_through_(std::ranges::any_of(description_.shapes, [this](const Shape& shape) {
        const Material& material = description_.materials[shape.material];
        return material.side[front].traits().is_see_through || material.side[back].traits().is_see_through;
      })) {}

namespace {

struct Parametrization {
  V2f uv;
  V3f dp_du, dp_dv;
};

// Tangents for surfaces without texture coordinates, or where these are the same at all corners.
void use_any_tangents(Parametrization& p, const V3f& normal) {
  const Frame frame(normal);
  p.dp_du = frame.s;
  p.dp_dv = frame.t;
}

Parametrization parametrization(const Mesh& mesh, const SurfacePoint& point, const V3f& normal) {
  Parametrization result{V2f(point.u, point.v), V3f(0.0f), V3f(0.0f)};
  use_any_tangents(result, normal);
  if (mesh.uvs.empty()) return result;
  const V3u& index = mesh.triangles[point.primitive];
  const V2f uv0 = mesh.uvs[index.x], duv1 = mesh.uvs[index.y] - uv0, duv2 = mesh.uvs[index.z] - uv0;
  result.uv = uv0 + duv1 * point.u + duv2 * point.v;
  const float determinant = duv1.x * duv2.y - duv1.y * duv2.x;
  const float inverse = 1.0f / determinant;
  if (determinant == 0.0f || !std::isfinite(inverse)) return result;
  const auto p = corners(mesh, point.primitive);
  const V3f e1 = p[1] - p[0], e2 = p[2] - p[0];
  result.dp_du = (e1 * duv2.y - e2 * duv1.y) * inverse;
  result.dp_dv = (e2 * duv1.x - e1 * duv2.x) * inverse;
  return result;
}

Parametrization parametrization(const Sphere& sphere, const SurfacePoint&, const V3f& normal) {
  const V3f outward = sphere.inward ? -normal : normal;
  const V3f& ax = sphere.axes[0];
  const V3f& ay = sphere.axes[1];
  const V3f& az = sphere.axes[2];
  const float x = outward.dot(ax), y = outward.dot(ay), z = outward.dot(az);
  const float around = std::atan2(y, x);
  Parametrization result{V2f((around < 0.0f ? around + 2.0f * pi_f : around) / (2.0f * pi_f),
                             std::acos(std::clamp(z, -1.0f, 1.0f)) / pi_f),
                         V3f(0.0f), V3f(0.0f)};
  const float rho = std::sqrt(x * x + y * y);
  if (!(rho > 0.0f)) {
    use_any_tangents(result, normal);
    return result;
  }
  result.dp_du = (ay * x - ax * y) * (2.0f * pi_f * sphere.radius);
  result.dp_dv = ((ax * x + ay * y) * (z / rho) - az * rho) * (pi_f * sphere.radius);
  return result;
}

}  // namespace

void Scene::add_parametrization(SurfacePoint& point, const Shape& shape, const V3f& normal) const {
  const Parametrization p = std::visit(
      [&](const auto& geometry) { return parametrization(geometry, point, normal); }, shape.geometry);
  point.uv = p.uv;
  point.dp_du = p.dp_du;
  point.dp_dv = p.dp_dv;
  const V3f& n = point.shading.n;
  const V3f s = p.dp_du - n * n.dot(p.dp_du);
  if (!(s.dot(s) > 0.0f) || !is_finite(s)) return;  // seen along the tangent: any frame will do
  point.shading.s = unit(s);
  point.shading.t = n.cross(point.shading.s);
}

Bsdf Scene::resolve_at(const MaterialSide& material, SurfacePoint& point, const V3f& direction, float u) {
  ShadingGeometry at{.uv = point.uv,
                     .dp_du = point.dp_du,
                     .dp_dv = point.dp_dv,
                     .wo = -direction,
                     .frame = point.shading,
                     .is_back = point.side == back};
  const Bsdf bsdf = material.resolve(at, u);
  point.terminator = at.terminator;
  point.unperturbed_normal = point.shading.n;
  point.shading = at.frame;
  return bsdf;
}

}  // namespace twopass
