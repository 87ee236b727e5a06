#include "render/load/shape_group.h"

#include "render/core/error.h"
#include "render/load/mesh_tools.h"
#include "render/scene/scene.h"

namespace twopass {
namespace {

V3d row(const M44d& m, int k) { return {m[k][0], m[k][1], m[k][2]}; }
V3d vector(const M44d& m, const V3d& v) { return row(m, 0) * v.x + row(m, 1) * v.y + row(m, 2) * v.z; }
V3d point(const M44d& m, const V3d& p) { return vector(m, p) + row(m, 3); }

/// What mirrors a mesh in its own coordinates.
M44d mirror_x() {
  M44d m;
  m[0][0] = -1.0;
  return m;
}

/// A grid over the unit square of texture coordinates, closed where the surface is.
template <class PositionAt, class NormalAt>
Mesh grid_mesh(int columns, int rows, PositionAt position_at, NormalAt normal_at) {
  Mesh mesh;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const V2d uv(static_cast<double>(i) / columns, static_cast<double>(j) / rows);
      mesh.positions.emplace_back(position_at(uv));
      mesh.normals.emplace_back(normal_at(uv));
      mesh.uvs.emplace_back(uv);
    }
  const auto index = [&](int i, int j) { return static_cast<std::uint32_t>(j * (columns + 1) + i); };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      mesh.triangles.emplace_back(index(i, j), index(i + 1, j), index(i + 1, j + 1));
      mesh.triangles.emplace_back(index(i, j), index(i + 1, j + 1), index(i, j + 1));
    }
  drop_degenerate_triangles(mesh);
  orient_by_normals(mesh);
  return mesh;
}

constexpr int around = 128;

V3d towards(const std::array<V3f, 3>& axes, double turns) {
  return V3d(axes[0]) * std::cos(2.0 * pi * turns) + V3d(axes[1]) * std::sin(2.0 * pi * turns);
}

Mesh mesh_of_sphere(const Sphere& sphere) {
  const auto outward = [&](const V2d& uv) {
    return towards(sphere.axes, uv.x) * std::sin(pi * uv.y) + V3d(sphere.axes[2]) * std::cos(pi * uv.y);
  };
  return grid_mesh(
      around, around / 2,
      [&](const V2d& uv) { return V3d(sphere.center) + outward(uv) * static_cast<double>(sphere.radius); },
      [&](const V2d& uv) { return sphere.inward ? -outward(uv) : outward(uv); });
}

Mesh mesh_of_cylinder(const Cylinder& cylinder) {
  return grid_mesh(
      around, 1,
      [&](const V2d& uv) {
        return V3d(cylinder.base) + V3d(cylinder.axes[2]) * (uv.y * cylinder.length) +
               towards(cylinder.axes, uv.x) * static_cast<double>(cylinder.radius);
      },
      [&](const V2d& uv) { return towards(cylinder.axes, uv.x) * (cylinder.inward ? -1.0 : 1.0); });
}

std::array<V3f, 3> turned(const std::array<V3f, 3>& axes, const M44d& m, double scale) {
  std::array<V3f, 3> result;
  for (std::size_t k = 0; k < 3; ++k) result[k] = V3f(vector(m, V3d(axes[k])) / scale);
  return result;
}

Placement placement_of(const M44d& m) {
  return {V3f(row(m, 0)), V3f(row(m, 1)), V3f(row(m, 2)), V3f(row(m, 3))};
}

/// An analytic surface where `m` puts it. REQUIRES: for spheres and cylinders `scale` > 0.
Geometry placed(const Geometry& geometry, const M44d& m, double scale) {
  if (const auto* sphere = std::get_if<Sphere>(&geometry))
    return Sphere{V3f(point(m, V3d(sphere->center))), static_cast<float>(sphere->radius * scale),
                  sphere->inward, turned(sphere->axes, m, scale)};
  if (const auto* disk = std::get_if<Disk>(&geometry))
    return Disk{V3f(point(m, V3d(disk->center))), V3f(vector(m, V3d(disk->x))), V3f(vector(m, V3d(disk->y))),
                disk->reversed != is_mirroring(m)};
  const auto& cylinder = std::get<Cylinder>(geometry);
  return Cylinder{V3f(point(m, V3d(cylinder.base))), static_cast<float>(cylinder.radius * scale),
                  static_cast<float>(cylinder.length * scale), cylinder.inward,
                  turned(cylinder.axes, m, scale)};
}

}  // namespace

double similarity_scale(const M44d& to_world) {
  const V3d x = row(to_world, 0), y = row(to_world, 1), z = row(to_world, 2);
  const double scale = x.length(), tolerance = 1e-4 * scale;  // exporters write six digits
  const bool is_similar = std::abs(y.length() - scale) <= tolerance &&
                          std::abs(z.length() - scale) <= tolerance &&
                          std::abs(x.dot(y)) <= tolerance * scale && std::abs(y.dot(z)) <= tolerance * scale &&
                          std::abs(z.dot(x)) <= tolerance * scale;
  return is_similar ? scale : 0.0;
}

ShapeGroup::ShapeGroup(std::vector<Shape> members) : members_(std::move(members)), meshes_(members_.size()) {}

std::shared_ptr<const Mesh> ShapeGroup::shared_mesh(std::size_t member, bool mirrored) {
  auto& meshes = meshes_[member];
  if (!meshes[0]) {
    Geometry& geometry = members_[member].geometry;
    if (auto* mesh = std::get_if<Mesh>(&geometry))
      meshes[0] = std::make_shared<const Mesh>(std::move(*mesh));
    else if (const auto* sphere = std::get_if<Sphere>(&geometry))
      meshes[0] = std::make_shared<const Mesh>(mesh_of_sphere(*sphere));
    else
      meshes[0] = std::make_shared<const Mesh>(mesh_of_cylinder(std::get<Cylinder>(geometry)));
  }
  if (mirrored && !meshes[1]) {
    Mesh mesh = *meshes[0];
    transform(mesh, mirror_x(), "");
    reverse_winding(mesh);
    meshes[1] = std::make_shared<const Mesh>(std::move(mesh));
  }
  return meshes[mirrored ? 1 : 0];
}

bool ShapeGroup::emits() const { return std::ranges::any_of(members_, is_emitter); }

bool ShapeGroup::is_placeable(const M44d& to_world) {
  const Placement p = placement_of(to_world);
  const float volume = p.x.cross(p.y).dot(p.z);
  return std::abs(volume) > 0.0f && std::isfinite(volume);
}

std::vector<Shape> ShapeGroup::place(const M44d& to_world, const std::string& name, const std::string& where,
                                     Notes& notes) {
  const bool mirrored = is_mirroring(to_world);
  const M44d m = mirrored ? mirror_x() * to_world : to_world;
  const Placement placement = placement_of(m);
  if (!is_placeable(to_world))
    throw Error(where, "the transform flattens the instance, or its numbers are too large or too small",
                "every axis needs a size; or use other units");
  const double scale = similarity_scale(to_world);
  std::vector<Shape> shapes;
  for (std::size_t k = 0; k < members_.size(); ++k) {
    const Shape& member = members_[k];
    Shape shape;
    shape.name = member.name.empty() ? name : name + "/" + member.name;
    shape.material = member.material;
    const bool is_mesh = std::holds_alternative<Mesh>(member.geometry);
    if (!is_mesh && (scale > 0.0 || std::holds_alternative<Disk>(member.geometry))) {
      shape.geometry = placed(member.geometry, to_world, scale);
    } else {
      if (!is_mesh) notes.add(where + ": '" + member.name + "' is stretched and becomes a mesh");
      shape.geometry = MeshInstance{shared_mesh(k, mirrored), placement};
    }
    shapes.push_back(std::move(shape));
  }
  const Box3f box = bounds_of(shapes);
  if (!box.isEmpty() &&
      !(max_abs_component(box.min) <= largest_coordinate && max_abs_component(box.max) <= largest_coordinate))
    throw Error(where, "a transformed coordinate is not finite or larger than 1e12",
                "use larger units or check the transform");
  return shapes;
}

}  // namespace twopass
