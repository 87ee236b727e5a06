// Rays, and what they hit.
#pragma once

#include "materials/material.h"
#include "render/core/frame.h"
#include "render/core/types.h"

namespace twopass {

inline constexpr std::uint32_t no_index = 0xffffffffu;

struct Ray {
  V3f origin;
  V3f direction;  ///< unit length unless a function says otherwise
};

/// A line between two points, both clear of their own surfaces.
struct Segment {
  V3f from, to;
};

/// The nearest intersection, in the ray caster's terms.
struct Hit {
  std::uint32_t shape = no_index;  ///< no_index: the ray escaped
  std::uint32_t primitive = 0;     ///< triangle of the mesh; 0 for an analytic surface
  float t = infinity_f;            ///< distance in units of the direction's length
  float u = 0.0f, v = 0.0f;        ///< barycentric coordinates of the triangle's corners 1 and 2; 0 elsewhere
  [[nodiscard]] bool escaped() const { return shape == no_index; }
};

/// A point of a surface as seen from a direction: all that shading, look-ups and new rays need.
struct SurfacePoint {
  V3f position;          ///< on the surface, clear of the edges of its triangle (L40)
  V3f geometric_normal;  ///< unit, on the viewer's side
  Frame shading;         ///< its normal is on the viewer's side
  float offset;  ///< how far along the normal a new ray must start to clear the surface's rounding errors
  float u, v;    ///< barycentric coordinates as in Hit
  std::uint32_t shape, primitive;
  Side side;  ///< the side that the viewer sees
  /// Texture coordinates, and how far they go along a unit of length; only where the material or its light
  /// needs them.
  V2f uv, uv_rate;
  V3f dp_du, dp_dv;  ///< the position's derivatives by them; only where the material needs tangents
  /// Width of the beam that textures are looked at through; 0: a ray.
  float beam_width = 0.0f;
  [[nodiscard]] TexturePoint where() const { return {uv, V2f(0.0f, 0.0f), {primitive, {u, v}}}; }
  /// Of (M30), with the shading normal before it was perturbed; 0 where it was not.
  float terminator = 0.0f;
  V3f unperturbed_normal;
};

/// Start of a ray that leaves the surface towards `direction` (Waechter and Binder, Ray Tracing Gems ch. 6: the
/// step scales with the coordinates' rounding, nothing is absolute).
inline V3f spawn_position(const SurfacePoint& point, const V3f& direction) {
  const float step = direction.dot(point.geometric_normal) >= 0.0f ? point.offset : -point.offset;
  return point.position + point.geometric_normal * step;
}

}  // namespace twopass
