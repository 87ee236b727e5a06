#include "render/image/flip_planes.h"

#include <cassert>

namespace twopass {
namespace {

// Linear sRGB to XYZ, from the primaries and the D65 white (0.3127, 0.3290) of IEC 61966-2-1; the rows sum to
// the white point, by which every use divides.
const Imath::M33d& rgb_to_xyz() {
  // Imath multiplies row vectors: v * M, so the standard's matrix stands here transposed.
  static const Imath::M33d matrix(10135552.0 / 24577794.0, 2613072.0 / 12288897.0, 1425312.0 / 73733382.0,
                                  8788810.0 / 24577794.0, 8788810.0 / 12288897.0, 8788810.0 / 73733382.0,
                                  4435075.0 / 24577794.0, 887015.0 / 12288897.0, 70074185.0 / 73733382.0);
  return matrix;
}

// The same with X, Y, Z relative to white.
const Imath::M33f& rgb_to_relative_xyz() {
  static const Imath::M33f matrix = [] {
    const V3d white = V3d(1.0, 1.0, 1.0) * rgb_to_xyz();
    Imath::M33f m;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) m[i][j] = static_cast<float>(rgb_to_xyz()[i][j] / white[j]);
    return m;
  }();
  return matrix;
}

const Imath::M33f& relative_xyz_to_rgb() {
  static const Imath::M33f matrix = Imath::M33f(Imath::M33d(rgb_to_relative_xyz()).inverse());
  return matrix;
}

// CIE 15: cube root above (6/29)^3, its tangent below.
float lab_curve(float t) {
  constexpr float delta = 6.0f / 29.0f;
  return t > delta * delta * delta ? std::cbrt(t) : t / (3.0f * delta * delta) + 4.0f / 29.0f;
}

}  // namespace

Plane filter_rows(const Plane& in, const Kernel& kernel) {
  const int radius = static_cast<int>(kernel.size() / 2);
  const auto width = static_cast<std::size_t>(in.width);
  Plane out(in.width, in.height);
  std::vector<float> padded(width + 2 * static_cast<std::size_t>(radius));
  for (int y = 0; y < in.height; ++y) {
    const float* row = in.row(y);
    std::fill_n(padded.begin(), radius, row[0]);
    std::copy_n(row, width, padded.begin() + radius);
    std::fill_n(padded.end() - radius, radius, row[width - 1]);
    float* result = out.row(y);
    // Tap by tap over the whole row: a loop that the compiler vectorises.
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      const float weight = kernel[k];
      const float* shifted = padded.data() + k;
      for (std::size_t x = 0; x < width; ++x) result[x] += weight * shifted[x];
    }
  }
  return out;
}

Plane filter_columns(const Plane& in, const Kernel& kernel, int skip) {
  const int radius = static_cast<int>(kernel.size() / 2);
  assert(radius <= skip && in.height > 2 * skip);
  Plane out(in.width, in.height - 2 * skip);
  for (int y = 0; y < out.height; ++y) {
    float* result = out.row(y);
    for (int k = -radius; k <= radius; ++k) {
      const float weight = kernel[static_cast<std::size_t>(k + radius)];
      const float* row = in.row(y + skip + k);
      for (int x = 0; x < in.width; ++x) result[x] += weight * row[x];
    }
  }
  return out;
}

C3f linear_to_ycxcz(const C3f& rgb) {
  const V3f xyz = rgb * rgb_to_relative_xyz();
  return {116.0f * xyz.y - 16.0f, 500.0f * (xyz.x - xyz.y), 200.0f * (xyz.y - xyz.z)};
}

C3f ycxcz_to_linear(const C3f& ycxcz) {
  const float y = (ycxcz.x + 16.0f) / 116.0f;
  return V3f(y + ycxcz.y / 500.0f, y, y - ycxcz.z / 200.0f) * relative_xyz_to_rgb();
}

C3f linear_to_hunt_lab(const C3f& rgb) {
  const V3f xyz = rgb * rgb_to_relative_xyz();
  const float x = lab_curve(xyz.x), y = lab_curve(xyz.y), z = lab_curve(xyz.z);
  const float lightness = 116.0f * y - 16.0f;
  return {lightness, 0.01f * lightness * 500.0f * (x - y), 0.01f * lightness * 200.0f * (y - z)};
}

float hyab(const C3f& a, const C3f& b) { return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); }

}  // namespace twopass
