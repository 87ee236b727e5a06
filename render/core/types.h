// The vocabulary of numbers: Imath's vectors, matrices and colours under short names, and a few helpers on
// them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <Imath/ImathBox.h>
#include <Imath/ImathColor.h>
#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

namespace twopass {

using V2f = Imath::V2f;
using V2d = Imath::V2d;
using V2i = Imath::V2i;
using V3f = Imath::V3f;
using V3d = Imath::V3d;
using V3u = Imath::Vec3<std::uint32_t>;
using M44f = Imath::M44f;
using M44d = Imath::M44d;
using Box3f = Imath::Box3f;
/// Three linear channels of the working space: radiance, irradiance, reflectance... the name of the variable
/// says which.
using C3f = Imath::C3f;
using C3d = Imath::Color3<double>;

inline constexpr float pi_f = 3.14159265358979323846f;
inline constexpr double pi = 3.14159265358979323846;
inline constexpr float infinity_f = std::numeric_limits<float>::infinity();

inline bool is_finite(const V2f& v) { return std::isfinite(v.x) && std::isfinite(v.y); }
inline bool is_finite(const V3f& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// v / |v|. Tiny vectors keep their direction; zero stays zero.
inline V3f unit(const V3f& v) {
  const float length2 = v.dot(v);
  if (length2 > 1e-30f && length2 < 1e30f)
    return v * (1.0f / std::sqrt(length2));  // no under- or overflow: the fast way
  return v.normalized();
}

inline float max_component(const V3f& v) { return std::max(v.x, std::max(v.y, v.z)); }
inline float max_abs_component(const V3f& v) {
  return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z)));
}
inline float mean_component(const V3f& v) { return (v.x + v.y + v.z) * (1.0f / 3.0f); }
inline bool is_black(const V3f& c) { return c.x == 0.0f && c.y == 0.0f && c.z == 0.0f; }

}  // namespace twopass
