// Analytic surfaces as geometries of Embree; internal to the ray caster.
#pragma once

#include <array>

#include "render/scene/embree.h"
#include "render/scene/geometry.h"
#include "render/scene/shape.h"

namespace twopass {

// The distances at which the line meets an analytic surface, ascending, the farther ones again if there are
// fewer than two. False: it misses.
inline bool meet(const Sphere& sphere, const V3f& origin, const V3f& direction, std::array<double, 2>& t) {
  return intersect_sphere(sphere, origin, direction, t[0], t[1]);
}
inline bool meet(const Disk& disk, const V3f& origin, const V3f& direction, std::array<double, 2>& t) {
  V2d at;
  if (!intersect_disk(disk, origin, direction, t[0], at)) return false;
  t[1] = t[0];
  return true;
}
inline bool meet(const Cylinder& cylinder, const V3f& origin, const V3f& direction, std::array<double, 2>& t) {
  std::array<double, 2> along;
  if (!intersect_cylinder(cylinder, origin, direction, t, along)) return false;
  const bool hits_near = along[0] >= 0.0 && along[0] <= 1.0, hits_far = along[1] >= 0.0 && along[1] <= 1.0;
  if (!hits_near) t[0] = t[1];
  if (!hits_far) t[1] = t[0];
  return hits_near || hits_far;
}

// The nearest distance within (tnear, tfar) at which the ray of a packet meets the surface; false if there is
// none.
template <class Surface>
bool nearest_in_range(const Surface& surface, RTCRayN* rays, unsigned n, unsigned lane, float& t) {
  const V3f origin(RTCRayN_org_x(rays, n, lane), RTCRayN_org_y(rays, n, lane), RTCRayN_org_z(rays, n, lane));
  const V3f direction(RTCRayN_dir_x(rays, n, lane), RTCRayN_dir_y(rays, n, lane), RTCRayN_dir_z(rays, n, lane));
  std::array<double, 2> met;
  if (!meet(surface, origin, direction, met)) return false;
  for (const double candidate : met) {
    t = static_cast<float>(candidate);
    if (t > RTCRayN_tnear(rays, n, lane) && t < RTCRayN_tfar(rays, n, lane)) return true;
  }
  return false;
}

template <class Surface>
const Surface& surface_of(void* user_data) {
  return *static_cast<const Surface*>(user_data);
}

template <class Surface>
void surface_bounds(const RTCBoundsFunctionArguments* args) {
  const auto& surface = surface_of<Surface>(args->geometryUserPtr);
  const V3f margin(rounding_offset(surface));
  const Box3f box = box_of(surface);
  const V3f lower = box.min - margin, upper = box.max + margin;
  args->bounds_o->lower_x = lower.x, args->bounds_o->upper_x = upper.x;
  args->bounds_o->lower_y = lower.y, args->bounds_o->upper_y = upper.y;
  args->bounds_o->lower_z = lower.z, args->bounds_o->upper_z = upper.z;
}

// Single rays are packets of one.
template <class Surface>
void surface_intersect(const RTCIntersectFunctionNArguments* args) {
  const unsigned n = args->N;
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, n);
  RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, n);
  for (unsigned lane = 0; lane < n; ++lane) {
    float t;
    if (args->valid[lane] == 0 ||
        !nearest_in_range(surface_of<Surface>(args->geometryUserPtr), rays, n, lane, t))
      continue;
    RTCRayN_tfar(rays, n, lane) = t;
    RTCHitN_geomID(hits, n, lane) = args->geomID;
    RTCHitN_primID(hits, n, lane) = args->primID;
    RTCHitN_instID(hits, n, lane, 0) = RTC_INVALID_GEOMETRY_ID;
    RTCHitN_u(hits, n, lane) = RTCHitN_v(hits, n, lane) = 0.0f;
  }
}

template <class Surface>
void surface_occluded(const RTCOccludedFunctionNArguments* args) {
  for (unsigned lane = 0; lane < args->N; ++lane) {
    float t;
    if (args->valid[lane] != 0 &&
        nearest_in_range(surface_of<Surface>(args->geometryUserPtr), args->ray, args->N, lane, t))
      RTCRayN_tfar(args->ray, args->N, lane) = -infinity_f;
  }
}

/// A geometry of one primitive, to be committed. REQUIRES: the surface outlives it.
template <class Surface>
RTCGeometry new_surface(RTCDevice device, const Surface& surface) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, 1);
  rtcSetGeometryUserData(geometry, const_cast<Surface*>(&surface));
  rtcSetGeometryBoundsFunction(geometry, surface_bounds<Surface>, nullptr);
  rtcSetGeometryIntersectFunction(geometry, surface_intersect<Surface>);
  rtcSetGeometryOccludedFunction(geometry, surface_occluded<Surface>);
  return geometry;
}

}  // namespace twopass
