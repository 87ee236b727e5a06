// Every scattering model through the same tests: density and Jacobian, reciprocity, energy, no NaN. A new model
// is one line in the table.
#include "materials/bsdf.h"

#include <string>

#include <gtest/gtest.h>

#include "materials/material.h"
#include "render/core/sampler.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

struct Case {
  std::string name;
  Bsdf bsdf;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

const Case cases[] = {
    {"diffuse", Diffuse{C3f(0.2f, 0.5f, 1.0f)}},
    {"black", Diffuse{C3f(0.0f)}},
    {"mirror", Conductor{}},
    {"metal", Conductor{C3f(0.2f, 0.9f, 1.1f), C3f(3.9f, 2.4f, 2.2f), C3f(1.0f)}},
    {"glass", Dielectric{}},
    {"glass_inside", Dielectric{1.0f / 1.5f, C3f(1.0f), C3f(1.0f)}},
    {"tinted_glass", Dielectric{1.5f, C3f(0.9f), C3f(0.1f, 0.5f, 0.9f)}},
    {"principled_thin", PrincipledThin{}},
};

V3f direction(float cos_theta, float phi) {
  const float s = std::sqrt(std::max(0.0f, 1.0f - cos_theta * cos_theta));
  return {s * std::cos(phi), s * std::sin(phi), cos_theta};
}

const float cosines[] = {1.0f, 0.9f, 0.5f, 0.1f, 1e-3f, 1e-6f};

class BsdfTest : public testing::TestWithParam<Case> {};

TEST_P(BsdfTest, SampleAgreesWithEvalAndPdf) {
  const Bsdf& bsdf = GetParam().bsdf;
  for (const float c : cosines) {
    const V3f wo = direction(c, 0.3f);
    for (std::uint32_t i = 0; i < 500; ++i) {
      Sampler sampler(1, 2, i);
      const auto drawn = sample(bsdf, wo, sampler.next_2d());
      if (!drawn) continue;
      ASSERT_TRUE(is_finite(drawn->wi) && is_finite(drawn->weight) && drawn->pdf_w > 0.0f);
      ASSERT_NEAR(drawn->wi.length(), 1.0f, 1e-4f);
      if (drawn->is_specular) {
        EXPECT_TRUE(is_black(eval(bsdf, wo, drawn->wi)));
        EXPECT_EQ(pdf_w(bsdf, wo, drawn->wi), 0.0f);
      } else {
        EXPECT_NEAR(pdf_w(bsdf, wo, drawn->wi), drawn->pdf_w, 1e-4f * drawn->pdf_w);
        const C3f f = eval(bsdf, wo, drawn->wi);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(f[k], drawn->weight[k] * drawn->pdf_w, 1e-5f);
      }
    }
  }
}

// A model returns at most what it receives; for radiance through an interface, after undoing its compression by
// eta^2.
TEST_P(BsdfTest, ReflectsAtMostWhatArrives) {
  const Bsdf& bsdf = GetParam().bsdf;
  for (const float c : cosines) {
    const V3f wo = direction(c, 0.3f);
    test::Estimate albedo;
    for (std::uint32_t i = 0; i < 4096; ++i) {
      Sampler sampler(1, 2, i);
      const auto drawn = sample(bsdf, wo, sampler.next_2d());
      albedo.add(drawn ? drawn->weight.z * drawn->eta * drawn->eta : 0.0);
    }
    EXPECT_LE(albedo.mean(), 1.0 + 1e-4);
  }
}

TEST_P(BsdfTest, IsReciprocal) {
  const Bsdf& bsdf = GetParam().bsdf;
  for (const float a : cosines)
    for (const float b : cosines) {
      const V3f wo = direction(a, 0.3f), wi = direction(b, 2.0f);
      const C3f there = eval(bsdf, wo, wi) * wo.z, back = eval(bsdf, wi, wo) * wi.z;
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(there[k], back[k], 1e-6f);
    }
}

// The density integrates to the probability of drawing a direction at all, by counting on a grid that is
// uniform in solid angle (rung 2 of the ladder: no statistics).
TEST_P(BsdfTest, DensityIntegratesToOneUnlessSpecularOrBlack) {
  const Bsdf& bsdf = GetParam().bsdf;
  if (is_specular(bsdf)) GTEST_SKIP() << "a Dirac delta has no density";
  constexpr int n = 400;
  double sum = 0.0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 8; ++j) {
      const float z = (static_cast<float>(i) + 0.5f) / n;
      sum += pdf_w(bsdf, direction(0.7f, 0.1f), direction(z, static_cast<float>(j))) * 2.0 * pi / (n * 8);
    }
  EXPECT_NEAR(sum, 1.0, 1e-4);
}

TEST_P(BsdfTest, DirectionsFollowTheDensity) {
  const Bsdf& bsdf = GetParam().bsdf;
  if (is_specular(bsdf) || is_black(diffuse_reflectance(bsdf))) GTEST_SKIP() << "nothing to count";
  constexpr int nz = 10, nphi = 8, n = 1 << 16;
  const V3f wo = direction(0.6f, 1.0f);
  std::vector<double> seen(nz * nphi, 0.0), expected(nz * nphi, 0.0);
  for (std::uint32_t i = 0; i < n; ++i) {
    Sampler sampler(3, i, 0);
    const V3f wi = sample(bsdf, wo, sampler.next_2d())->wi;
    const float phi = std::atan2(wi.y, wi.x) + pi_f;
    seen[std::min(nz - 1, static_cast<int>(wi.z * nz)) * nphi +
         std::min(nphi - 1, static_cast<int>(phi / (2 * pi_f) * nphi))] += 1;
  }
  for (int a = 0; a < nz; ++a)
    for (int b = 0; b < nphi; ++b)
      for (int k = 0; k < 64; ++k)
        expected[a * nphi + b] +=
            n * 2.0 * pi / (nz * nphi * 64) *
            pdf_w(bsdf, wo,
                  direction((static_cast<float>(a) + (static_cast<float>(k) + 0.5f) / 64) / nz,
                            (static_cast<float>(b) + 0.5f) / nphi * 2 * pi_f - pi_f));
  EXPECT_GT(test::chi2_test(seen, expected), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Models, BsdfTest, testing::ValuesIn(cases),
                         [](const testing::TestParamInfo<Case>& model) { return model.param.name; });

TEST(Dielectric, TransmitsBackTheWayItCame) {
  const Material glass = interface_material("glass", Dielectric{1.5f, C3f(1.0f), C3f(1.0f)});
  const V3f wo = direction(0.8f, 0.5f);
  const auto in = sample(glass.side[front], wo, V2f(0.999f, 0.0f));
  ASSERT_LT(in->wi.z, 0.0f);
  // Seen from inside, +z points to the inside.
  const auto out = sample(glass.side[back], V3f(in->wi.x, in->wi.y, -in->wi.z), V2f(0.999f, 0.0f));
  ASSERT_LT(out->wi.z, 0.0f);
  EXPECT_NEAR(out->wi.x, wo.x, 1e-5f);
  EXPECT_NEAR(out->wi.y, wo.y, 1e-5f);
  EXPECT_NEAR(-out->wi.z, wo.z, 1e-5f);
  // Compression of radiance and its undoing cancel.
  EXPECT_NEAR(in->weight.x * out->weight.x, 1.0f, 1e-5f);
}

TEST(Material, OneSidedIsBlackBehind) {
  const Material wall = one_sided("wall", Diffuse{C3f(0.7f)});
  EXPECT_TRUE(is_black(diffuse_reflectance(wall.side[back])));
  EXPECT_FALSE(sample(wall.side[back], V3f(0, 0, 1), V2f(0.5f, 0.5f)).has_value());
}

}  // namespace
}  // namespace twopass
