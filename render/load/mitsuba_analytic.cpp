#include "render/load/mitsuba_analytic.h"

#include "render/core/error.h"
#include "render/core/frame.h"
#include "render/load/mesh_tools.h"
#include "render/scene/geometry.h"

namespace twopass {
namespace {

V3d vector(const M44d& m, const V3d& v) {
  V3d result;
  m.multDirMatrix(v, result);
  return result;
}
V3d point(const M44d& m, const V3d& p) {
  V3d result;
  m.multVecMatrix(p, result);
  return result;
}

/// Throws where a box is not of reasonable size.
void check_box(const Box3f& box, Properties& p) {
  if (!(max_abs_component(box.min) <= largest_coordinate && max_abs_component(box.max) <= largest_coordinate))
    throw Error(p.where("to_world"), "the " + p.type() + " is too large or too far away", "use other units");
}

}  // namespace

Disk read_mitsuba_disk(Properties& p) {
  const M44d m = p.transform("to_world");
  Disk disk{V3f(point(m, V3d(0.0))), V3f(vector(m, V3d(1.0, 0.0, 0.0))), V3f(vector(m, V3d(0.0, 1.0, 0.0))),
            p.boolean("flip_normals", false) != is_mirroring(m)};
  // The normal is that of +z, wherever the other axes go; flat in z, it has none, and the winding decides.
  const auto area = static_cast<float>(area_of(disk));
  if (!(area > 0.0f) || !std::isfinite(area) || !(unit_normal(disk).length() > 0.5f))
    throw Error(p.where("to_world"), "the disk has no area, or is too large or too small",
                "check the transform");
  check_box(box_of(disk), p);
  return disk;
}

Cylinder read_mitsuba_cylinder(Properties& p) {
  const V3d p0 = p.point("p0", V3d(0.0)), p1 = p.point("p1", V3d(0.0, 0.0, 1.0));
  const double radius = p.number("radius").value_or(1.0), length = (p1 - p0).length();
  if (!(radius > 0.0)) throw Error(p.where("radius"), "a cylinder's radius must be positive", "correct it");
  if (!(length > 0.0)) throw Error(p.where("p1"), "a cylinder's ends p0 and p1 must differ", "correct them");
  // Where textures start around it: any frame around the axis, the same as Mitsuba's.
  const Frame frame(unit(V3f((p1 - p0) / length)));
  const M44d m = p.transform("to_world");
  const V3d z = (p1 - p0) / length, x = (V3d(frame.s) - z * z.dot(V3d(frame.s))).normalized(), y = z.cross(x);
  const V3d world_x = vector(m, x), world_y = vector(m, y), world_z = vector(m, z);
  const double scale = world_x.length(), tolerance = 1e-4, along = world_z.length();
  const bool is_cylinder = scale > 0.0 && along > 0.0 &&
                           std::abs(world_y.length() - scale) <= tolerance * scale &&
                           std::abs(world_x.dot(world_y)) <= tolerance * scale * scale &&
                           std::abs(world_x.dot(world_z)) <= tolerance * scale * along &&
                           std::abs(world_y.dot(world_z)) <= tolerance * scale * along;
  if (!is_cylinder)
    throw Error(p.where("to_world"), "the transform makes of the cylinder what is none",
                "scale it uniformly, or along its axis, or use a mesh");
  const Cylinder cylinder{V3f(point(m, p0)),
                          static_cast<float>(radius * scale),
                          static_cast<float>(length * along),
                          p.boolean("flip_normals", false),
                          {V3f(world_x / scale), V3f(world_y.normalized()), V3f(world_z / along)}};
  if (!(cylinder.radius > 0.0f) || !(cylinder.length > 0.0f))
    throw Error(p.where("to_world"), "the cylinder is too small", "use other units");
  check_box(box_of(cylinder), p);
  return cylinder;
}

}  // namespace twopass
