#include "render/scene/parametrization.h"

#include "render/core/frame.h"

namespace twopass {

Parametrization any_parametrization(const V2f& uv, const V3f& normal) {
  const Frame any(normal);
  return {uv, any.s, any.t};
}

Parametrization parametrization(const std::array<V3f, 3>& p, const std::array<V2f, 3>& uvs,
                                const V2f& barycentric, const V3f& normal) {
  const V2f duv1 = uvs[1] - uvs[0], duv2 = uvs[2] - uvs[0];
  const V2f uv = interpolated(uvs, barycentric);
  const float determinant = duv1.x * duv2.y - duv1.y * duv2.x;
  const float inverse = 1.0f / determinant;
  if (determinant == 0.0f || !std::isfinite(inverse)) return any_parametrization(uv, normal);
  const V3f e1 = p[1] - p[0], e2 = p[2] - p[0];
  return {uv, (e1 * duv2.y - e2 * duv1.y) * inverse, (e2 * duv1.x - e1 * duv2.x) * inverse};
}

Parametrization parametrization(const Mesh& mesh, std::uint32_t triangle, const V2f& barycentric,
                                const V3f& normal) {
  if (mesh.uvs.empty()) return any_parametrization(barycentric, normal);
  const V3u& index = mesh.triangles[triangle];
  return parametrization(corners(mesh, triangle), {mesh.uvs[index.x], mesh.uvs[index.y], mesh.uvs[index.z]},
                         barycentric, normal);
}

Parametrization parametrization(const Sphere& sphere, const V3f& normal) {
  const V3f outward = sphere.inward ? -normal : normal;
  const V3f &ax = sphere.axes[0], &ay = sphere.axes[1], &az = sphere.axes[2];
  const float x = outward.dot(ax), y = outward.dot(ay), z = outward.dot(az);
  const float around = std::atan2(y, x);
  const Frame any(normal);
  Parametrization result{V2f((around < 0.0f ? around + 2.0f * pi_f : around) / (2.0f * pi_f),
                             std::acos(std::clamp(z, -1.0f, 1.0f)) / pi_f),
                         any.s, any.t};
  const float rho = std::sqrt(x * x + y * y);
  if (!(rho > 0.0f)) return result;
  result.dp_du = (ay * x - ax * y) * (2.0f * pi_f * sphere.radius);
  result.dp_dv = ((ax * x + ay * y) * (z / rho) - az * rho) * (pi_f * sphere.radius);
  return result;
}

Parametrization parametrization(const Disk& disk, const V3f& position) {
  const V3d x(disk.x), y(disk.y), p = V3d(position) - V3d(disk.center), normal = x.cross(y);
  const double n2 = normal.dot(normal);
  const double a = normal.dot(p.cross(y)) / n2, b = normal.dot(x.cross(p)) / n2, radius = std::hypot(a, b);
  const auto turns = static_cast<float>(std::atan2(b, a) / (2.0 * pi));
  const auto cosine = static_cast<float>(radius > 0.0 ? a / radius : 1.0),
             sine = static_cast<float>(radius > 0.0 ? b / radius : 0.0);
  // dp_dv vanishes in the middle, where u and v turn around: there the direction remains.
  const float around = 2.0f * pi_f * std::max(static_cast<float>(radius), 1e-6f);
  return {V2f(static_cast<float>(radius), turns < 0.0f ? turns + 1.0f : turns), disk.x * cosine + disk.y * sine,
          (disk.y * cosine - disk.x * sine) * around};
}

Parametrization parametrization(const Cylinder& cylinder, const V3f& position) {
  const V3f &ax = cylinder.axes[0], &ay = cylinder.axes[1], &az = cylinder.axes[2];
  float along;
  const V3f outward = outward_at(cylinder, position, along);
  const float x = outward.dot(ax), y = outward.dot(ay), turns = std::atan2(y, x) / (2.0f * pi_f);
  return {V2f(turns < 0.0f ? turns + 1.0f : turns, along), (ay * x - ax * y) * (2.0f * pi_f * cylinder.radius),
          az * cylinder.length};
}

V2f barycentric_at(const std::array<V3f, 3>& p, const V3f& position) {
  const V3d e1 = V3d(p[1]) - V3d(p[0]), e2 = V3d(p[2]) - V3d(p[0]), d = V3d(position) - V3d(p[0]);
  const double d11 = e1.dot(e1), d12 = e1.dot(e2), d22 = e2.dot(e2), b1 = d.dot(e1), b2 = d.dot(e2);
  const double determinant = d11 * d22 - d12 * d12;
  if (!(determinant > 0.0)) return {0.0f, 0.0f};
  return {static_cast<float>((d22 * b1 - d12 * b2) / determinant),
          static_cast<float>((d11 * b2 - d12 * b1) / determinant)};
}

}  // namespace twopass
