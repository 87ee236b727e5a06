#include "materials/microfacet.h"

#include <gtest/gtest.h>

#include "materials/fresnel.h"
#include "materials/rough_conductor.h"
#include "materials/rough_dielectric.h"
#include "render/core/error.h"

namespace twopass {
namespace {

V3f at_angles(double cosine, double phi) {
  const double s = std::sqrt(1.0 - cosine * cosine);
  return V3f(V3d(s * std::cos(phi), s * std::sin(phi), cosine));
}

struct Roughness {
  Microfacet type;
  float u, v;
};
const Roughness surfaces[] = {{Microfacet::beckmann, 1e-4f, 1e-4f}, {Microfacet::beckmann, 0.1f, 0.1f},
                              {Microfacet::beckmann, 1.0f, 1.0f},   {Microfacet::beckmann, 0.05f, 0.6f},
                              {Microfacet::ggx, 1e-4f, 1e-4f},      {Microfacet::ggx, 0.1f, 0.1f},
                              {Microfacet::ggx, 1.0f, 1.0f},        {Microfacet::ggx, 0.05f, 0.6f}};
const float cosines_of_views[] = {1.0f, 0.8f, 0.3f, 0.01f, 1e-4f};

// The sum of visit(m) over all facet normals, on a grid in slopes that is logarithmic in their length.
template <class Visit>
double integral_over_facets(const Roughness& surface, Visit visit) {
  constexpr int radii = 400, angles = 100;
  const double low = std::log(1e-4), high = std::log(1e4 / std::min(surface.u, surface.v));
  const double dr = (high - low) / radii, da = 2.0 * pi / angles;
  double sum = 0.0;
  for (int i = 0; i < radii; ++i)
    for (int j = 0; j < angles; ++j) {
      const double r = std::exp(low + (i + 0.5) * dr), a = (j + 0.5) * da;
      const V3d slope(surface.u * r * std::cos(a), surface.v * r * std::sin(a), 1.0);
      const double z = 1.0 / std::sqrt(slope.dot(slope));
      sum += visit(V3f(slope * z)) * surface.u * surface.v * r * r * dr * da * z * z * z;
    }
  return sum;
}

// The facets project onto the surface they make up.
TEST(Microfacet, FacetsCoverTheSurface) {
  for (const Roughness& s : surfaces) {
    const MicrofacetDistribution facets(s.type, s.u, s.v);
    const double covered = integral_over_facets(s, [&](const V3f& m) { return facets.density(m) * m.z; });
    EXPECT_NEAR(covered, 1.0, 2e-5) << s.u << " " << s.v;
  }
}

// The visible facets project onto the surface's projection, too: exactly by the density of sampled normals, to
// 0.35 % for Beckmann's masking.
TEST(Microfacet, VisibleFacetsCoverTheProjectedSurface) {
  for (const Roughness& s : surfaces)
    for (const float c : cosines_of_views) {
      const V3f wo = at_angles(c, 0.7);
      const MicrofacetDistribution facets(s.type, s.u, s.v);
      const double drawn = integral_over_facets(s, [&](const V3f& m) { return facets.pdf_w(wo, m); });
      EXPECT_NEAR(drawn, 1.0, 1e-3) << s.u << " " << s.v << " cosine " << c;
      const double seen = integral_over_facets(s, [&](const V3f& m) {
        return facets.density(m) * facets.masking(wo, m) * std::max(wo.dot(m), 0.0f) / wo.z;
      });
      EXPECT_NEAR(seen, 1.0, s.type == Microfacet::ggx ? 1e-3 : 4.5e-3) << s.u << " " << s.v << " cosine " << c;
    }
}

TEST(Microfacet, KnownDensities) {
  // D = 1 / (pi alpha^2) at the pole for both.
  for (const Microfacet type : {Microfacet::beckmann, Microfacet::ggx})
    EXPECT_NEAR(MicrofacetDistribution(type, 0.5f, 0.2f).density(V3f(0, 0, 1)), 1.0 / (pi * 0.1), 1e-5);
  // At 45 degrees along u: exp(-1 / alpha^2) / (pi alpha_u alpha_v cos^4), and 1 / (pi alpha^2 cos^4 (1 + 1 /
  // alpha^2)^2).
  const V3f m = at_angles(std::sqrt(0.5), 0.0);
  EXPECT_NEAR(MicrofacetDistribution(Microfacet::beckmann, 0.5f, 0.2f).density(m),
              4.0 * std::exp(-4.0) / (pi * 0.1), 1e-6);
  EXPECT_NEAR(MicrofacetDistribution(Microfacet::ggx, 0.5f, 0.2f).density(m), 4.0 / (pi * 0.1 * 25.0), 1e-6);
}

TEST(Microfacet, KnownMasking) {
  // GGX of roughness 1 at 45 degrees: 2 / (1 + sqrt(2)).
  const V3f v = at_angles(std::sqrt(0.5), 1.0), m(0, 0, 1);
  EXPECT_NEAR(MicrofacetDistribution(Microfacet::ggx, 1.0f, 1.0f).masking(v, m), 2.0 / (1.0 + std::sqrt(2.0)),
              1e-6);
  // Beckmann there, a = 1: 2 / (1 + erf(1) + exp(-1) / sqrt(pi)), to 0.35 %.
  const double exact = 2.0 / (1.0 + std::erf(1.0) + std::exp(-1.0) / std::sqrt(pi));
  EXPECT_NEAR(MicrofacetDistribution(Microfacet::beckmann, 1.0f, 1.0f).masking(v, m), exact, 0.0035 * exact);
  EXPECT_EQ(MicrofacetDistribution(Microfacet::beckmann, 0.3f, 0.3f).masking(V3f(0, 0, 1), m), 1.0f);
  // The backs of facets are not seen.
  EXPECT_EQ(MicrofacetDistribution(Microfacet::ggx, 1.0f, 1.0f).masking(v, -v), 0.0f);
  EXPECT_EQ(
      MicrofacetDistribution(Microfacet::ggx, 1.0f, 1.0f).masking(at_angles(0.2, 0.0), at_angles(0.5, pi)),
      0.0f);
}

// The map from the unit square to normals stretches areas as the density says: finite differences.
TEST(Microfacet, SampledNormalsFollowTheDensityEverywhere) {
  constexpr float h = 1e-3f;
  for (const Roughness& s : surfaces)
    for (const float c : {0.99f, 0.5f, 0.1f}) {
      const MicrofacetDistribution facets(s.type, s.u, s.v);
      const V3f wo = at_angles(c, 0.7);
      for (const float x : {0.1f, 0.45f, 0.8f, 0.95f})
        for (const float y : {0.07f, 0.33f, 0.6f, 0.9f}) {
          const V3f dx = facets.sample(wo, V2f(x + h, y)) - facets.sample(wo, V2f(x - h, y)),
                    dy = facets.sample(wo, V2f(x, y + h)) - facets.sample(wo, V2f(x, y - h));
          const float area = dx.cross(dy).length() / (4.0f * h * h);
          const float tolerance = 0.01f + 2e-7f / (h * std::min(s.u, s.v));  // differences of floats
          if (tolerance > 0.3f) continue;
          EXPECT_NEAR(facets.pdf_w(wo, facets.sample(wo, V2f(x, y))) * area, 1.0f, tolerance)
              << s.u << " " << s.v << " cosine " << c << " at " << x << ", " << y;
        }
    }
}

TEST(Microfacet, CornersOfTheSquareGiveFacetsThatAreSeen) {
  const float below_one = 1.0f - 0x1p-24f;
  for (const Roughness& s : surfaces)
    for (const float c : {1.0f, 0.5f, 1e-3f, 1e-6f})
      for (const float x : {0.0f, 0x1p-24f, 0.5f, below_one})
        for (const float y : {0.0f, 0.25f, 0.5f, below_one}) {
          const MicrofacetDistribution facets(s.type, s.u, s.v);
          const V3f wo = at_angles(c, 0.7), m = facets.sample(wo, V2f(x, y));
          ASSERT_TRUE(is_finite(m) && m.z >= 0.0f) << s.u << " " << s.v << " " << c << " at " << x << ", " << y;
          ASSERT_NEAR(m.length(), 1.0f, 1e-6f);
          ASSERT_GT(wo.dot(m), -1e-6f);
          ASSERT_TRUE(std::isfinite(facets.pdf_w(wo, m)));
        }
}

// The solid angle of reflected and refracted directions over that of the facets, by finite differences in
// double precision, times their density is the facets' (Walter et al. 2007, equations 13 to 17).
V3d reflected(const V3d& wo, const V3d& m) { return m * (2.0 * wo.dot(m)) - wo; }
V3d refracted(const V3d& wo, const V3d& m, double eta) {
  const double c = wo.dot(m);
  return m * (c / eta - std::sqrt(1.0 - (1.0 - c * c) / (eta * eta))) - wo * (1.0 / eta);
}
template <class Warp>
double stretch(const V3d& m, Warp warp) {
  const double h = 1e-6;
  V3d s = m.cross(std::abs(m.x) < 0.7 ? V3d(1, 0, 0) : V3d(0, 1, 0));
  s *= 1.0 / std::sqrt(s.dot(s));
  const V3d t = m.cross(s);
  const auto at = [&](const V3d& step) {
    const V3d moved = m + step * h;
    return warp(moved * (1.0 / std::sqrt(moved.dot(moved))));
  };
  const V3d area = (at(s) - at(-s)).cross(at(t) - at(-t));
  return std::sqrt(area.dot(area)) / (4.0 * h * h);
}

TEST(Microfacet, DensitiesOfDirectionsAreThoseOfFacetsOverTheStretch) {
  for (const Microfacet type : {Microfacet::beckmann, Microfacet::ggx})
    for (const float eta : {1.5f, 1.0f / 1.5f})
      for (const double c : {0.95, 0.6, 0.3})
        for (const double mc : {0.99, 0.9, 0.7}) {
          const MicrofacetDistribution facets(type, 0.3f, 0.5f);
          const V3d wo(at_angles(c, 0.7)), m(at_angles(mc, 1.1));
          const float visible = facets.pdf_w(V3f(wo), V3f(m));
          float cos_t;
          const float fresnel = fresnel_dielectric(static_cast<float>(wo.dot(m)), eta, cos_t);
          const RoughDielectric glass{eta, C3f(1.0f), C3f(1.0f), 0.3f, 0.5f, type};
          const RoughConductor metal{C3f(0.0f), C3f(1.0f), C3f(1.0f), 0.3f, 0.5f, type};
          const auto mirror = [&](const V3d& n) { return reflected(wo, n); };
          if (mirror(m).z > 0.01) {
            const V3f wi(mirror(m));
            EXPECT_NEAR(metal.pdf_w(V3f(wo), wi) * stretch(m, mirror), visible, 1e-3 * visible);
            EXPECT_NEAR(glass.pdf_w(V3f(wo), wi) * stretch(m, mirror), visible * fresnel, 1e-3 * visible);
          }
          const auto through = [&](const V3d& n) { return refracted(wo, n, eta); };
          if (fresnel < 1.0f && through(m).z < -0.01) {
            const float pdf = glass.pdf_w(V3f(wo), V3f(through(m)));
            EXPECT_NEAR(pdf * stretch(m, through), visible * (1.0 - fresnel), 2e-3 * visible);
          }
        }
}

TEST(Microfacet, PhongExponents) {
  EXPECT_FLOAT_EQ(beckmann_alpha_of_phong(0.0f), 1.0f);
  EXPECT_FLOAT_EQ(beckmann_alpha_of_phong(198.0f), 0.1f);
}

TEST(Microfacet, HasNames) {
  EXPECT_EQ(value_of_name<Microfacet>(microfacet_names, "ggx", "here", "distribution"), Microfacet::ggx);
  EXPECT_THROW(value_of_name<Microfacet>(microfacet_names, "phong", "here", "distribution"), Error);
}

}  // namespace
}  // namespace twopass
