// Queries of Embree, of single rays and of packets; internal to the ray caster.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "render/core/types.h"
#include "render/scene/embree.h"

namespace twopass {

// Embree builds with asserts abort on rays that are not finite or start further out than this.
inline constexpr float largest_coordinate = 1e18f;

// One sum, which is not a number or too large if any coordinate is.
inline bool is_valid(const V3f& origin, const V3f& direction) {
  return std::abs(origin.x) + std::abs(origin.y) + std::abs(origin.z) + std::abs(direction.x) +
             std::abs(direction.y) + std::abs(direction.z) <
         largest_coordinate;
}

template <int N>
using PacketRay = std::conditional_t<N == 16, RTCRay16, RTCRay8>;
template <int N>
using PacketRayHit = std::conditional_t<N == 16, RTCRayHit16, RTCRayHit8>;

// The one difference between Embree 3 and 4 that queries see.
#if TWOPASS_EMBREE_VERSION >= 4
inline void query_intersect(RTCScene scene, RTCRayHit& ray_hit) { rtcIntersect1(scene, &ray_hit, nullptr); }
inline void query_occluded(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray, nullptr); }
template <int N>
void query_intersect(RTCScene scene, const int* valid, PacketRayHit<N>& packet, bool coherent) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  if constexpr (N == 16)
    rtcIntersect16(valid, scene, &packet, &arguments);
  else
    rtcIntersect8(valid, scene, &packet, &arguments);
}
template <int N>
void query_occluded(RTCScene scene, const int* valid, PacketRay<N>& packet, bool coherent) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  if constexpr (N == 16)
    rtcOccluded16(valid, scene, &packet, &arguments);
  else
    rtcOccluded8(valid, scene, &packet, &arguments);
}
#else
struct Context : RTCIntersectContext {
  explicit Context(bool coherent = false) {
    rtcInitIntersectContext(this);
    if (coherent) flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  }
};
inline void query_intersect(RTCScene scene, RTCRayHit& ray_hit) {
  Context context;
  rtcIntersect1(scene, &context, &ray_hit);
}
inline void query_occluded(RTCScene scene, RTCRay& ray) {
  Context context;
  rtcOccluded1(scene, &context, &ray);
}
template <int N>
void query_intersect(RTCScene scene, const int* valid, PacketRayHit<N>& packet, bool coherent) {
  Context context(coherent);
  if constexpr (N == 16)
    rtcIntersect16(valid, scene, &context, &packet);
  else
    rtcIntersect8(valid, scene, &context, &packet);
}
template <int N>
void query_occluded(RTCScene scene, const int* valid, PacketRay<N>& packet, bool coherent) {
  Context context(coherent);
  if constexpr (N == 16)
    rtcOccluded16(valid, scene, &context, &packet);
  else
    rtcOccluded8(valid, scene, &context, &packet);
}
#endif

// Written field by field in place: copying a finished ray would stall on its own stores.
inline void set_ray(RTCRay& ray, const V3f& origin, const V3f& direction, float t_far) {
  ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
  ray.tnear = 0.0f;
  ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
  ray.time = 0.0f;
  ray.tfar = t_far;
  ray.mask = 0xffffffffu;
  ray.id = 0;
  ray.flags = 0;
}

template <int N>
void put(PacketRay<N>& rays, std::size_t lane, const V3f& origin, const V3f& direction) {
  rays.org_x[lane] = origin.x, rays.org_y[lane] = origin.y, rays.org_z[lane] = origin.z;
  rays.dir_x[lane] = direction.x, rays.dir_y[lane] = direction.y, rays.dir_z[lane] = direction.z;
}

// What is the same in all packets, and is left alone by Embree.
template <int N>
void set_constants(PacketRay<N>& rays) {
  std::fill_n(rays.tnear, N, 0.0f);
  std::fill_n(rays.time, N, 0.0f);
  std::fill_n(rays.mask, N, 0xffffffffu);
  std::fill_n(rays.id, N, 0u);
  std::fill_n(rays.flags, N, 0u);
}

// What remains to be set when `count` rays have been put in. Lanes that are empty, or hold what Embree must not
// see, are switched off and get a harmless ray. Plain loops over arrays, for vector instructions.
template <int N>
void finish(PacketRay<N>& rays, int* valid, std::size_t count, float t_far) {
  const V3f zero(0.0f), up(0.0f, 0.0f, 1.0f);
  for (std::size_t lane = count; lane < N; ++lane) put<N>(rays, lane, zero, up);
  int all = -1;
  for (std::size_t i = 0; i < N; ++i) {
    valid[i] =
        is_valid({rays.org_x[i], rays.org_y[i], rays.org_z[i]}, {rays.dir_x[i], rays.dir_y[i], rays.dir_z[i]})
            ? -1
            : 0;
    all &= valid[i];
    rays.tfar[i] = t_far;
  }
  if (all == 0) [[unlikely]]
    for (std::size_t lane = 0; lane < count; ++lane)
      if (valid[lane] == 0) put<N>(rays, lane, zero, up);
  for (std::size_t lane = count; lane < N; ++lane) valid[lane] = 0;
}

// The rounding of `direction` moves the end of a segment by some units in the last place of the whole length.
inline constexpr float segment_end = 1.0f - 16.0f * std::numeric_limits<float>::epsilon();

}  // namespace twopass
