#include "radiosity/local_albedo.h"

#include "render/scene/parametrization.h"

namespace twopass {

namespace {

// Texture coordinates at a point of a piece with the given barycentric coordinates of its corners 1 and 2.
V2f texture_coordinates(const Geometry& geometry, std::uint32_t piece, const V2f& at) {
  if (const Mesh* mesh = mesh_of(geometry)) return parametrization(*mesh, piece, at, V3f(0.0f, 0.0f, 1.0f)).uv;
  constexpr float steps = 4096.0f;
  const V2i numerators(static_cast<int>(std::lround(at.x * steps)),
                       static_cast<int>(std::lround(at.y * steps)));
  const V3f position(piece_grid_point(geometry, piece, numerators, static_cast<std::uint32_t>(steps)));
  if (const auto* sphere = std::get_if<Sphere>(&geometry)) {
    const V3f outward = unit(position - sphere->center);
    return parametrization(*sphere, sphere->inward ? -outward : outward).uv;
  }
  if (const auto* disk = std::get_if<Disk>(&geometry)) return parametrization(*disk, position).uv;
  return parametrization(std::get<Cylinder>(geometry), position).uv;
}

V2f barycentric(const V2i& numerators, std::uint32_t divisions) {
  return V2f(static_cast<float>(numerators.x), static_cast<float>(numerators.y)) /
         static_cast<float>(divisions);
}

}  // namespace

C3f mean_albedo(const Shape& shape, const MaterialSide& material, const ElementRoot& root,
                const ElementCell& cell) {
  C3f sum(0.0f);
  for (int quarter = 0; quarter < 4; ++quarter)
    for (int sixteenth = 0; sixteenth < 4; ++sixteenth) {
      const ElementCell part = child_cell(child_cell(cell, quarter), sixteenth);
      const std::array<V2i, 3> corner = cell_corners(part);
      const V2f middle = barycentric(corner[0] + corner[1] + corner[2], 3 * part.divisions);
      TexturePoint where(texture_coordinates(shape.geometry, root.primitive, middle));
      if (mesh_of(shape.geometry) != nullptr) {
        // Linear there, so that the corners tell the extent.
        for (const V2i& numerators : corner) {
          const V2f uv =
              texture_coordinates(shape.geometry, root.primitive, barycentric(numerators, part.divisions));
          for (int axis = 0; axis < 2; ++axis)
            where.footprint[axis] = std::max(where.footprint[axis], std::abs(uv[axis] - where.uv[axis]));
        }
        where.place = {root.primitive, middle};
      }
      sum += material.diffuse_reflectance(where);
    }
  return sum * (1.0f / 16.0f);
}

}  // namespace twopass
