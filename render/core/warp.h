// Maps from the unit square to directions and surfaces, each with its density. Names say the measure: _w solid
// angle, _a area.
#pragma once

#include <array>
#include <bit>

#include "render/core/types.h"

namespace twopass {

/// The point of the unit circle at `u` turns, u in [0, 1], to 4e-7. A fraction of the cost of sine and cosine
/// from the library, which showed in profiles.
inline V2f circle(float u) {
  const int quadrant = static_cast<int>(4.0f * u + 0.5f);
  const float x = (u - 0.25f * static_cast<float>(quadrant)) * (2.0f * pi_f);  // in [-pi/4, pi/4]
  const float x2 = x * x;
  // Taylor polynomials: the first omitted terms are 3e-7 x and 2.5e-8 there.
  const float s = x * (1.0f + x2 * (-1.0f / 6 + x2 * (1.0f / 120 + x2 * (-1.0f / 5040))));
  const float c = 1.0f + x2 * (-0.5f + x2 * (1.0f / 24 + x2 * (-1.0f / 720 + x2 * (1.0f / 40320))));
  // Turned by the quadrant with bits instead of branches, which random angles would mispredict.
  const auto bits_s = std::bit_cast<std::uint32_t>(s), bits_c = std::bit_cast<std::uint32_t>(c);
  const auto q = static_cast<std::uint32_t>(quadrant);
  const std::uint32_t exchange = (bits_s ^ bits_c) & (0u - (q & 1u));
  return {std::bit_cast<float>((bits_c ^ exchange) ^ ((q + 1u) & 2u) << 30),
          std::bit_cast<float>((bits_s ^ exchange) ^ (q & 2u) << 30)};
}

/// Cosine-weighted direction of the upper hemisphere (z >= 0).
inline V3f square_to_cosine_hemisphere(const V2f& u) {
  const float radius = std::sqrt(u.x);
  const V2f around = circle(u.y) * radius;
  return {around.x, around.y, std::sqrt(1.0f - u.x)};
}
inline float cosine_hemisphere_pdf_w(float cos_theta) { return std::max(cos_theta, 0.0f) * (1.0f / pi_f); }

/// Uniform barycentric coordinates (u, v) of the corners 1 and 2 of a triangle.
inline V2f square_to_triangle(const V2f& u) {
  // Folding the square keeps stratification better than the square root map (Heitz 2019); no branch to
  // mispredict.
  const float half = 0.5f * std::min(u.x, u.y);
  return {u.x - half, u.y - half};
}

/// Point of the unit disk for one of the square from -1 to 1, with constant density (Shirley and Chiu 1997):
/// each of the four triangles between the middle and an edge becomes the quarter of the disk around it.
template <class V2>
V2 square_to_disk_concentric(const V2& p) {
  using T = typename V2::BaseType;
  constexpr T quarter = T(pi / 4);
  if (p.x == 0 && p.y == 0) return V2(0, 0);
  if (std::abs(p.x) >= std::abs(p.y)) {
    const T angle = quarter * (p.y / p.x);
    return V2(p.x * std::cos(angle), p.x * std::sin(angle));
  }
  const T angle = quarter * (p.x / p.y);
  return V2(p.y * std::sin(angle), p.y * std::cos(angle));
}
/// Uniform point of the unit disk.
inline V2f square_to_disk(const V2f& u) {
  return square_to_disk_concentric(V2f(2.0f * u.x - 1.0f, 2.0f * u.y - 1.0f));
}

/// Uniform direction.
inline V3f square_to_sphere(const V2f& u) {
  const float z = 1.0f - 2.0f * u.x;
  const float radius = std::sqrt(std::max(0.0f, 1.0f - z * z));
  const V2f around = circle(u.y) * radius;
  return {around.x, around.y, z};
}

/// Uniform direction of the cone of directions around +z with 1 - cos(half angle) = `one_minus_cos_max`.
inline V3f square_to_cone(const V2f& u, float one_minus_cos_max) {
  const float one_minus_z = u.x * one_minus_cos_max;
  // 1 - z^2 without cancellation, so that narrow cones keep their digits.
  const float radius = std::sqrt(std::max(0.0f, one_minus_z * (2.0f - one_minus_z)));
  const V2f around = circle(u.y) * radius;
  return {around.x, around.y, 1.0f - one_minus_z};
}
inline float cone_pdf_w(float one_minus_cos_max) { return 1.0f / (2.0f * pi_f * one_minus_cos_max); }

/// Point of the unit square with a density that is bilinear between its corners; their weights, >= 0 and not
/// all zero, in the order (0,0), (1,0), (1,1), (0,1).
inline V2f square_to_bilinear(const V2f& u, const std::array<float, 4>& weight) {
  const auto linear = [](float at, float a, float b) {
    const float root = std::sqrt((1.0f - at) * a * a + at * b * b);
    return a + root > 0.0f ? std::min(1.0f, at * (a + b) / (a + root)) : at;
  };
  const float x = linear(u.x, weight[0] + weight[3], weight[1] + weight[2]);
  return {x, linear(u.y, weight[0] + x * (weight[1] - weight[0]), weight[3] + x * (weight[2] - weight[3]))};
}
/// The density of square_to_bilinear() per unit of the square's area.
inline float bilinear_pdf_a(const V2f& p, const std::array<float, 4>& weight) {
  const float below = weight[0] + p.x * (weight[1] - weight[0]),
              above = weight[3] + p.x * (weight[2] - weight[3]);
  return 4.0f * (below + p.y * (above - below)) / (weight[0] + weight[1] + weight[2] + weight[3]);
}

/// Point of the spherical triangle (a, b, c), uniform in solid angle (Arvo 1995). a, b, c are unit vectors; the
/// result is one too. REQUIRES: a triangle of non-zero solid angle, smaller than a hemisphere.
V3d square_to_spherical_triangle(double u, double v, const V3d& a, const V3d& b, const V3d& c);
/// Solid angle of the spherical triangle, sr (Van Oosterom and Strackee 1983).
double spherical_triangle_solid_angle(const V3d& a, const V3d& b, const V3d& c);

}  // namespace twopass
