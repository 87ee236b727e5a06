#include "render/core/warp.h"

#include <gtest/gtest.h>

#include "render/core/sampler.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

constexpr double level = 1e-4;  // of each chi-square test

// Counts directions in cells of equal solid angle (z by phi) and compares with the density's mean over each
// cell.
template <class Map, class Density>
double direction_test(Map map, Density density, bool whole_sphere) {
  constexpr int nz = 16, nphi = 16, n = 1 << 17;
  std::vector<double> seen(nz * nphi, 0.0), expected(nz * nphi, 0.0);
  const float z_min = whole_sphere ? -1.0f : 0.0f;
  for (std::uint32_t i = 0; i < n; ++i) {
    // A new stream for every sample: independent numbers, as the test assumes.
    Sampler sampler(7, i, 0);
    const V3f w = map(sampler.next_2d());
    EXPECT_NEAR(w.length(), 1.0f, 1e-5f);
    const float phi = std::atan2(w.y, w.x) + pi_f;
    const int cz = std::min(nz - 1, static_cast<int>((w.z - z_min) / (1.0f - z_min) * nz));
    const int cp = std::min(nphi - 1, static_cast<int>(phi / (2.0f * pi_f) * nphi));
    seen[cz * nphi + cp] += 1.0;
  }
  for (int cz = 0; cz < nz; ++cz)
    for (int cp = 0; cp < nphi; ++cp)
      for (int k = 0; k < 64; ++k) {
        const float z =
            z_min + (1.0f - z_min) * (static_cast<float>(cz) + (static_cast<float>(k) + 0.5f) / 64) / nz;
        expected[cz * nphi + cp] += density(z) * n * 2.0 * pi * (1.0f - z_min) / (nz * nphi * 64);
      }
  return test::chi2_test(seen, expected);
}

TEST(Warp, CircleIsSineAndCosine) {
  for (int i = 0; i <= 100000; ++i) {
    const float u = static_cast<float>(i) / 100000;
    const V2f p = circle(u);
    ASSERT_NEAR(p.x, std::cos(2.0 * pi * u), 4e-7) << u;
    ASSERT_NEAR(p.y, std::sin(2.0 * pi * u), 4e-7) << u;
  }
}

TEST(Warp, CosineHemisphereHasItsDensity) {
  EXPECT_GT(direction_test(square_to_cosine_hemisphere, cosine_hemisphere_pdf_w, false), level);
}

TEST(Warp, SphereIsUniform) {
  EXPECT_GT(direction_test(
                square_to_sphere, [](float) { return 1.0f / (4.0f * pi_f); }, true),
            level);
}

// The tests themselves must be able to fail.
TEST(Warp, WrongDensityIsFound) {
  const auto slightly_off = [](float z) { return (0.95f * z + 0.025f) / pi_f; };
  EXPECT_LT(direction_test(square_to_cosine_hemisphere, slightly_off, false), level);
}

TEST(Warp, ConeIsUniformAndStaysInside) {
  for (const float spread : {1e-6f, 0.1f, 1.0f}) {
    test::Estimate z;
    for (std::uint32_t i = 0; i < 20000; ++i) {
      Sampler sampler(7, i, 0);
      const V3f w = square_to_cone(sampler.next_2d(), spread);
      // z itself has no digits left in narrow cones; the sine does.
      const double one_minus_z = (w.x * w.x + w.y * w.y) / (1.0 + w.z);
      EXPECT_LE(one_minus_z, spread * 1.0001);
      z.add(one_minus_z / spread);
    }
    EXPECT_NEAR(z.mean(), 0.5, 5 * z.standard_error());
  }
  EXPECT_NEAR(cone_pdf_w(1.0f), 1.0f / (2.0f * pi_f), 1e-7f);
}

TEST(Warp, TriangleIsUniform) {
  constexpr int n = 1 << 16, cells = 8;
  std::vector<double> seen(cells * cells, 0.0), expected(cells * cells, 0.0);
  for (std::uint32_t i = 0; i < n; ++i) {
    Sampler sampler(8, i, 0);
    const V2f b = square_to_triangle(sampler.next_2d());
    ASSERT_GE(b.x, 0.0f);
    ASSERT_GE(b.y, 0.0f);
    ASSERT_LE(b.x + b.y, 1.0f + 1e-6f);
    seen[static_cast<int>(b.x * cells) * cells + static_cast<int>(b.y * cells)] += 1.0;
  }
  // Half a square: cells below the diagonal whole, on it half.
  for (int x = 0; x < cells; ++x)
    for (int y = 0; x + y < cells; ++y)
      expected[x * cells + y] = (x + y == cells - 1 ? 1.0 : 2.0) * n / (cells * cells);
  EXPECT_GT(test::chi2_test(seen, expected), level);
}

TEST(Warp, SolidAngleOfAnOctantIsHalfPi) {
  EXPECT_NEAR(spherical_triangle_solid_angle({1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 0.5 * pi, 1e-15);
}

// Uniform in solid angle: the fraction that falls into each part of a triangle cut in four is the part's share.
TEST(Warp, SphericalTriangleIsUniform) {
  const auto unit = [](const V3d& v) { return v / v.length(); };
  const V3d a = unit({1, 0.1, 0.2}), b = unit({-0.1, 1, 0.3}), c = unit({0.2, -0.3, 1});
  const V3d ab = unit(a + b), bc = unit(b + c), ca = unit(c + a);
  const std::array<std::array<V3d, 3>, 4> parts{{{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}};
  const auto inside = [](const V3d& w, const std::array<V3d, 3>& t) {
    return w.dot(t[0].cross(t[1])) >= 0 && w.dot(t[1].cross(t[2])) >= 0 && w.dot(t[2].cross(t[0])) >= 0;
  };
  constexpr int n = 1 << 16;
  std::vector<double> seen(4, 0.0), expected;
  for (std::uint32_t i = 0; i < n; ++i) {
    Sampler sampler(9, i, 0);
    const V2f u = sampler.next_2d();
    const V3d w = square_to_spherical_triangle(u.x, u.y, a, b, c);
    EXPECT_NEAR(w.length(), 1.0, 1e-12);
    for (int k = 0; k < 4; ++k)
      if (inside(w, parts[k])) {
        seen[k] += 1.0;
        break;
      }
  }
  const double whole = spherical_triangle_solid_angle(a, b, c);
  for (const auto& p : parts) expected.push_back(n * spherical_triangle_solid_angle(p[0], p[1], p[2]) / whole);
  EXPECT_GT(test::chi2_test(seen, expected), level);
}

}  // namespace
}  // namespace twopass
