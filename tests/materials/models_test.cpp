// What single models must do: closed forms, limits and known values. The suite for all of them is
// bsdf_test.cpp.
#include <gtest/gtest.h>

#include "materials/energy.h"
#include "materials/ior.h"
#include "materials/material.h"
#include "render/core/sampler.h"
#include "tests/materials/cases.h"
#include "tests/materials/facet_grid.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

using test::direction;

/// Mean weight by channel over samples, and of those, of Dirac deltas, transmission and reflection.
struct Means {
  C3d all{0.0}, dirac{0.0}, reflected{0.0}, transmitted{0.0};
};
template <class Model>
Means means_of(const Model& model, const V3f& wo) {
  constexpr int n = 1 << 14;
  Means means;
  for (std::uint32_t i = 0; i < n; ++i) {
    Sampler sampler(7, 1, i);
    const auto drawn = model.sample(wo, sampler.next_2d());
    if (!drawn) continue;
    const C3d weight = C3d(drawn->weight.x, drawn->weight.y, drawn->weight.z) * (1.0 / n);
    means.all += weight;
    if (drawn->is_specular) means.dirac += weight;
    (drawn->wi.z > 0.0f ? means.reflected : means.transmitted) += weight;
  }
  return means;
}

/// Albedo under uniform light of what eval() returns: the mean over views, cosine-weighted, by quadrature.
template <class Model>
double albedo_of(const Model& model) {
  constexpr int n = 24;
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    const V3f wo = direction(std::sqrt((static_cast<float>(i) + 0.5f) / n), 0.4f);
    test::FacetGrid(wo, 0.5f, 0.5f, 0.0f).for_each_point([&](int, const V3f& wi, double angle) {
      if (wi.z > 0.0f) sum += model.eval(wo, wi).x * angle / n;
    });
  }
  return sum;
}

TEST(Dielectric, TransmitsBackTheWayItCame) {
  const Material glass = interface_material("glass", Dielectric{1.5f, C3f(1.0f), C3f(1.0f)});
  const V3f wo = direction(0.8f, 0.5f);
  const auto in = sample(glass.side[front].uniform(), wo, V2f(0.999f, 0.0f));
  ASSERT_LT(in->wi.z, 0.0f);
  // Seen from inside, +z points to the inside.
  const auto out = sample(glass.side[back].uniform(), V3f(in->wi.x, in->wi.y, -in->wi.z), V2f(0.999f, 0.0f));
  ASSERT_LT(out->wi.z, 0.0f);
  EXPECT_NEAR(out->wi.x, wo.x, 1e-5f);
  EXPECT_NEAR(out->wi.y, wo.y, 1e-5f);
  EXPECT_NEAR(-out->wi.z, wo.z, 1e-5f);
  // Compression of radiance and its undoing cancel.
  EXPECT_NEAR(in->weight.x * out->weight.x, 1.0f, 1e-5f);
}

TEST(RoughConductor, KnownValues) {
  // Straight down: F / (4 pi alpha_u alpha_v) for both distributions, F = ((1 - eta)^2 + k^2) / ((1 + eta)^2 +
  // k^2).
  const double fresnel = (0.8 * 0.8 + 9.0) / (1.2 * 1.2 + 9.0);
  for (const Microfacet type : {Microfacet::beckmann, Microfacet::ggx}) {
    const RoughConductor metal{C3f(0.2f), C3f(3.0f), C3f(0.5f), 0.1f, 0.3f, type};
    const V3f up(0, 0, 1);
    EXPECT_NEAR(metal.eval(up, up).x, 0.5 * fresnel / (4.0 * pi * 0.03), 1e-5);
    EXPECT_NEAR(metal.pdf_w(up, up), 1.0 / (4.0 * pi * 0.03), 1e-5);
  }
  // A mirror direction at 45 degrees, GGX of roughness 1: D = 1 / pi and G1 = 2 / (1 + sqrt(2)), so that
  // D G1^2 / (4 cos) = (3 - 2 sqrt(2)) sqrt(2) / pi.
  const RoughConductor mirror{C3f(0.0f), C3f(1.0f), C3f(1.0f), 1.0f, 1.0f, Microfacet::ggx};
  const float c = std::sqrt(0.5f);
  EXPECT_NEAR(mirror.eval(V3f(c, 0, c), V3f(-c, 0, c)).y, (3.0 - 2.0 * std::sqrt(2.0)) * std::sqrt(2.0) / pi,
              1e-5);
}

TEST(RoughConductor, TendsToTheSmoothOne) {
  const C3f eta(0.2f, 0.9f, 1.1f), k(3.9f, 2.4f, 2.2f);
  for (const Microfacet type : {Microfacet::beckmann, Microfacet::ggx})
    for (const float c : {1.0f, 0.6f, 0.1f}) {
      const V3f wo = direction(c, 1.0f);
      const Means rough = means_of(RoughConductor{eta, k, C3f(1.0f), 1e-4f, 1e-4f, type}, wo);
      const C3f smooth = Conductor{eta, k, C3f(1.0f)}.sample(wo, V2f(0.5f, 0.5f))->weight;
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(rough.all[i], smooth[i], 2e-3);
    }
}

TEST(RoughDielectric, TendsToTheSmoothOne) {
  for (const Microfacet type : {Microfacet::beckmann, Microfacet::ggx})
    for (const float eta : {1.5f, 1.0f / 1.5f})
      for (const float c : {1.0f, 0.8f, 0.5f, 0.1f}) {
        const V3f wo = direction(c, 1.0f);
        const RoughDielectric rough{eta, C3f(1.0f), C3f(1.0f), 1e-4f, 1e-4f, type};
        const Means means = means_of(rough, wo);
        float cos_t;
        const float reflected = fresnel_dielectric(c, eta, cos_t);
        EXPECT_NEAR(means.reflected.x, reflected, 0.01);  // the number of reflected samples is a random one
        EXPECT_NEAR(means.transmitted.x, (1.0 - reflected) / (eta * eta), 0.01 / (eta * eta));
        const auto drawn = rough.sample(wo, V2f(0.5f, 0.9f));
        ASSERT_TRUE(drawn.has_value());
        const V3f through(-wo.x / eta, -wo.y / eta, -cos_t), mirror(-wo.x, -wo.y, wo.z);
        EXPECT_LT((drawn->wi - (drawn->wi.z < 0.0f ? through : mirror)).length(), 5e-3f);
      }
}

// Radiance: f(wo, wi) eta^2 = f(wi, wo) across the interface, eta being that from wo's side (Veach 1997,
// eq. 5.14).
TEST(RoughDielectric, IsReciprocalAcrossTheInterface) {
  for (const Microfacet type : {Microfacet::beckmann, Microfacet::ggx})
    for (const float eta : {1.5f, 0.6f}) {
      const Material glass = material_of("g", RoughDielectric{eta, C3f(1.0f), C3f(0.7f), 0.2f, 0.4f, type});
      const auto &outside = std::get<RoughDielectric>(glass.side[front].uniform()),
                 &inside = std::get<RoughDielectric>(glass.side[back].uniform());
      int compared = 0;
      for (const float c : {0.9f, 0.5f, 0.2f})
        for (std::uint32_t i = 0; i < 100; ++i) {
          const V3f wo = direction(c, 0.3f);
          Sampler sampler(2, 2, i);
          const auto drawn = outside.sample(wo, sampler.next_2d());
          if (!drawn || drawn->wi.z >= -0.01f) continue;
          const auto flipped = [](const V3f& w) { return V3f(w.x, w.y, -w.z); };
          const float there = outside.eval(wo, drawn->wi).x / -drawn->wi.z,
                      back = inside.eval(flipped(drawn->wi), flipped(wo)).x / wo.z;
          EXPECT_NEAR(there * eta * eta, back, 1e-3f * back);
          ++compared;
        }
      EXPECT_GT(compared, 50);
    }
}

// Lossless facets lose only what bounces more than once: at most a tenth at this roughness, nothing when
// smooth.
TEST(RoughDielectric, LosesLittle) {
  for (const Microfacet type : {Microfacet::beckmann, Microfacet::ggx})
    for (const float eta : {1.5f, 1.0f / 1.5f}) {
      const Means means =
          means_of(RoughDielectric{eta, C3f(1.0f), C3f(1.0f), 0.2f, 0.2f, type}, direction(0.8f, 0.0f));
      const double power = means.reflected.x + means.transmitted.x * eta * eta;
      EXPECT_LE(power, 1.0);
      EXPECT_GT(power, 0.9);
    }
}

TEST(ThinDielectric, SumsTheBouncesBetweenItsFaces) {
  // At normal incidence F = 0.04 for 1.5: 2 F / (1 + F) = 1 / 13 comes back.
  const ThinDielectric pane{1.5f, C3f(0.5f), C3f(1.0f)};
  const auto back = pane.sample(V3f(0, 0, 1), V2f(0.0f, 0.0f));
  EXPECT_NEAR(back->pdf_w, 1.0 / 13.0, 1e-6);
  EXPECT_EQ(back->weight, C3f(0.5f));
  const V3f wo = direction(0.3f, 1.0f);
  const auto through = pane.sample(wo, V2f(0.9999f, 0.0f));
  EXPECT_EQ(through->wi, -wo);
  EXPECT_EQ(through->eta, 1.0f);
  // R + T R T + T R^3 T + ... term by term.
  float cos_t;
  const double f = fresnel_dielectric(0.3f, 1.5f, cos_t);
  double sum = f, term = (1.0 - f) * f * (1.0 - f);
  for (int i = 0; i < 60; ++i, term *= f * f) sum += term;
  EXPECT_NEAR(through->pdf_w, 1.0 - sum, 1e-5);
}

TEST(Null, LetsEverythingThrough) {
  const V3f wo = direction(1e-6f, 1.0f);
  const auto drawn = Null{}.sample(wo, V2f(0.5f, 0.5f));
  EXPECT_EQ(drawn->wi, -wo);
  EXPECT_EQ(drawn->weight, C3f(1.0f));
  EXPECT_EQ(drawn->pdf_w, 1.0f);
  EXPECT_EQ(drawn->eta, 1.0f);
  EXPECT_TRUE(drawn->is_specular);
}

TEST(Fresnel, DiffuseReflectanceIsTheMeanOverTheCosine) {
  for (const float eta : {0.1f, 1.0f / 3.0f, 1.0f / 1.8f, 1.0f / 1.5f, 1.0f / 1.1f, 1.1f, 1.5f, 2.5f}) {
    double mean = 0.0;
    constexpr int n = 20000;
    float cos_t;
    for (int i = 0; i < n; ++i)  // uniform in the square of the cosine
      mean += fresnel_dielectric(std::sqrt((static_cast<float>(i) + 0.5f) / n), eta, cos_t) / n;
    EXPECT_NEAR(fresnel_diffuse_reflectance(eta), mean, eta < 0.6f ? 0.004 : 0.0015) << eta;
  }
}

TEST(Plastic, CoatReflectsAsADielectric) {
  const Plastic plastic{1.5f, C3f(0.3f), C3f(0.5f), false};
  for (const float c : {1.0f, 0.5f, 0.05f}) {
    float cos_t;
    EXPECT_NEAR(means_of(plastic, direction(c, 0.0f)).dirac.x, 0.5 * fresnel_dielectric(c, 1.5f, cos_t), 2e-4);
  }
}

// A white base under a coat that absorbs nothing returns all light: what goes in comes out.
TEST(Plastic, WhiteFurnace) {
  for (const bool nonlinear : {false, true})
    for (const float eta : {1.2f, 1.49f, 1.9f})
      for (const float c : {1.0f, 0.5f, 0.1f}) {
        const Means means = means_of(Plastic{eta, C3f(1.0f), C3f(1.0f), nonlinear}, direction(c, 0.0f));
        EXPECT_NEAR(means.all.x, 1.0, 6e-3) << eta << " " << c;  // 0.6 %: the fit of the internal reflectance
      }
}

// At the ends of the range, too, plastic reflects no less than nothing and no more than all.
TEST(Plastic, OfAnyIndexReflectsAShare) {
  for (const float eta : {smallest_ior, 0.1f, 0.4f, 2.1f, 10.0f, largest_ior})
    for (const bool nonlinear : {false, true}) {
      const C3f white(1.0f);
      RoughPlastic rough;
      rough.eta = eta;
      rough.base_reflectance = white;
      rough.nonlinear = nonlinear;
      rough.prepare();
      const V3f wo = direction(0.6f, 0.0f);
      for (const double albedo :
           {means_of(Plastic{eta, white, white, nonlinear}, wo).all.x, means_of(rough, wo).all.x,
            static_cast<double>(rough.diffuse_reflectance().x),
            static_cast<double>(Plastic{eta, white, white, nonlinear}.diffuse_reflectance().x)}) {
        EXPECT_GE(albedo, 0.0) << eta;
        EXPECT_LE(albedo, 1.03) << eta;
      }
    }
}

TEST(Plastic, NonlinearBouncesDarken) {
  // rho / (1 - rho R) is less than rho / (1 - R), and its ratio known.
  const float internal = fresnel_diffuse_reflectance(1.0f / 1.5f);
  const V3f wo = direction(0.7f, 0.0f), wi = direction(0.4f, 1.0f);
  const float linear = Plastic{1.5f, C3f(0.5f), C3f(1.0f), false}.eval(wo, wi).x,
              tinted = Plastic{1.5f, C3f(0.5f), C3f(1.0f), true}.eval(wo, wi).x;
  EXPECT_NEAR(tinted / linear, (1.0f - internal) / (1.0f - 0.5f * internal), 1e-5f);
}

TEST(Plastic, DiffuseReflectanceIsTheBasesAlbedo) {
  for (const bool nonlinear : {false, true}) {
    const Plastic plastic{1.5f, C3f(0.6f), C3f(1.0f), nonlinear};
    EXPECT_NEAR(plastic.diffuse_reflectance().x, albedo_of(plastic), 3e-3);
  }
}

RoughPlastic prepared(RoughPlastic model) {
  model.prepare();
  return model;
}

TEST(RoughPlastic, TendsToTheSmoothOne) {
  // The rough one takes the internal reflectance as a mean over 64 nodes, 1.6 % below the integral.
  const Plastic smooth{1.5f, C3f(0.5f), C3f(1.0f), false};
  const RoughPlastic rough =
      prepared({1.5f, C3f(0.5f), C3f(1.0f), 1e-4f, Microfacet::beckmann, false, nullptr});
  for (const float c : {1.0f, 0.5f, 0.2f}) {
    const V3f wo = direction(c, 0.0f), wi = direction(0.6f, 2.0f);
    EXPECT_NEAR(rough.eval(wo, wi).x / smooth.eval(wo, wi).x, 0.975, 0.012);
  }
  EXPECT_NEAR(rough.diffuse_reflectance().x / smooth.diffuse_reflectance().x, 0.975, 0.012);
}

TEST(RoughPlastic, TableHoldsWhatTheCoatTransmits) {
  for (const Microfacet type : {Microfacet::beckmann, Microfacet::ggx})
    for (const float c : {1.0f, 20.0f / 63.0f, 5.0f / 63.0f}) {
      const RoughPlastic plastic = prepared({1.5f, C3f(0.0f), C3f(1.0f), 0.3f, type, false, nullptr});
      const Means coat =
          means_of(RoughDielectric{1.5f, C3f(1.0f), C3f(1.0f), 0.3f, 0.3f, type}, direction(c, 0.0f));
      EXPECT_NEAR(plastic.coat->transmittance_at(c), coat.transmitted.x * 1.5 * 1.5, 5e-3) << c;
    }
}

TEST(RoughPlastic, DiffuseReflectanceIsTheBasesAlbedo) {
  const RoughPlastic plastic = prepared({1.5f, C3f(0.6f), C3f(0.0f), 0.3f, Microfacet::ggx, true, nullptr});
  EXPECT_NEAR(plastic.diffuse_reflectance().x, albedo_of(plastic), 2e-3);
}

TEST(RoughPlastic, EqualCoatsShareATable) {
  const RoughPlastic a = prepared({1.5f, C3f(0.6f), C3f(1.0f), 0.3f, Microfacet::ggx, true, nullptr});
  RoughPlastic b = prepared({1.5f, C3f(0.1f), C3f(0.0f), 0.3f, Microfacet::ggx, false, nullptr});
  EXPECT_EQ(a.coat, b.coat);
  b.alpha = 0.2f;
  b.prepare();
  EXPECT_NE(a.coat, b.coat);
  EXPECT_EQ(b.coat->alpha, 0.2f);
}

TEST(RoughDiffuse, IsLambertsWhenSmooth) {
  for (const bool fast : {false, true}) {
    const RoughDiffuse plaster{C3f(0.2f, 0.5f, 1.0f), 0.0f, fast};
    for (const float c : {1.0f, 0.3f, 1e-3f})
      EXPECT_NEAR(plaster.eval(direction(c, 0.0f), direction(0.6f, 2.0f)).y, 0.5 * 0.6 / pi, 1e-6);
    EXPECT_EQ(plaster.diffuse_reflectance(), C3f(0.2f, 0.5f, 1.0f));
  }
}

TEST(RoughDiffuse, KnownValues) {
  // From straight above only the constant terms are left: rho C1 + rho^2 C4 (Oren and Nayar 1994).
  const double s2 = 0.5 * 0.5 * 0.5, c1 = 1.0 - 0.5 * s2 / (s2 + 0.33), c4 = 0.17 * s2 / (s2 + 0.13);
  const V3f up(0, 0, 1), wi = direction(0.5f, 1.0f);
  EXPECT_NEAR((RoughDiffuse{C3f(0.8f), 0.5f, false}.eval(up, wi).x), (0.8 * c1 + 0.64 * c4) * 0.5 / pi, 1e-6);
  EXPECT_NEAR((RoughDiffuse{C3f(0.8f), 0.5f, true}.eval(up, wi).x), 0.8 * c1 * 0.5 / pi, 1e-6);
  // Viewer and light together at 60 degrees: sin tan = 3 / 2, and (2 beta / pi)^2 = 4 / 9.
  const double c2 = 0.45 * s2 / (s2 + 0.09);
  EXPECT_NEAR((RoughDiffuse{C3f(0.8f), 0.5f, true}.eval(wi, wi).x), 0.8 * (c1 + c2 * 1.5) * 0.5 / pi, 1e-5);
  EXPECT_NEAR((RoughDiffuse{C3f(0.8f), 0.5f, false}.eval(wi, wi).x),
              (0.8 * (c1 + c2 * 1.5) + 0.64 * c4 * (1.0 - 4.0 / 9.0)) * 0.5 / pi, 1e-5);
}

TEST(RoughDiffuse, DiffuseReflectanceIsTheAlbedo) {
  for (const bool fast : {false, true})
    for (const float alpha : {0.2f, 0.7f}) {
      const RoughDiffuse plaster{C3f(0.8f), alpha, fast};
      EXPECT_NEAR(plaster.diffuse_reflectance().x, albedo_of(plaster), 1e-3);
    }
}

TEST(Phong, KnownValues) {
  const Phong phong{C3f(0.5f), C3f(0.2f), 30.0f};
  const V3f wo = direction(0.6f, 1.0f), mirror(-wo.x, -wo.y, wo.z);
  EXPECT_NEAR(phong.eval(wo, mirror).x, 0.6 * (0.5 / pi + 0.2 * 32.0 / (2.0 * pi)), 1e-5);
  EXPECT_NEAR(phong.pdf_w(wo, mirror), 0.5 / 0.7 * 0.6 / pi + 0.2 / 0.7 * 31.0 / (2.0 * pi), 1e-5);
  // Straight down the whole lobe is over the horizon: its albedo is the specular reflectance.
  EXPECT_NEAR(means_of(Phong{C3f(0.0f), C3f(0.2f), 30.0f}, V3f(0, 0, 1)).all.x, 0.2, 1e-4);
}

TEST(Ward, KnownValues) {
  // In the mirror direction the Gaussian is 1: 1 / (4 pi a b) over sqrt(cos cos), cos cos and (|wo + wi| cos)^2
  // / 4.
  const V3f wo = direction(0.6f, 1.0f), mirror(-wo.x, -wo.y, wo.z);
  const double peak = 1.0 / (4.0 * pi * 0.1 * 0.3);
  const auto value = [&](WardVariant variant) {
    return Ward{C3f(0.0f), C3f(1.0f), 0.1f, 0.3f, variant}.eval(wo, mirror).x / 0.6;
  };
  EXPECT_NEAR(value(WardVariant::ward), peak / 0.6, 1e-4);
  EXPECT_NEAR(value(WardVariant::duer), peak / 0.36, 1e-4);
  EXPECT_NEAR(value(WardVariant::balanced), peak / 0.36, 1e-4);
  // Off it: wo straight up, wi at 45 degrees along u, so that the half vector is at 22.5.
  const float c = std::sqrt(0.5f);
  const double tan2 = std::pow(std::tan(pi / 8.0), 2), length2 = 2.0 + std::sqrt(2.0),
               z4 = std::pow(1.0 + c, 4);
  const Ward balanced{C3f(0.0f), C3f(1.0f), 0.5f, 0.3f, WardVariant::balanced};
  EXPECT_NEAR(balanced.eval(V3f(0, 0, 1), V3f(c, 0, c)).x,
              c * length2 / (pi * 0.15 * z4) * std::exp(-tan2 / 0.25), 1e-5);
}

TEST(Energy, ScalesOnlyWhatReflectsTooMuch) {
  EXPECT_EQ(energy_conserving_scale(C3f(0.2f), C3f(0.8f)), 1.0f);
  EXPECT_FLOAT_EQ(energy_conserving_scale(C3f(0.2f, 1.5f, 0.0f), C3f(0.5f)), 0.99f / 2.0f);
}

}  // namespace
}  // namespace twopass
