// Every scattering model through the same tests: density and weights, reciprocity, energy, no NaN. The models
// are in cases.h.
#include "materials/bsdf.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "materials/material.h"
#include "render/core/sampler.h"
#include "tests/materials/cases.h"
#include "tests/materials/facet_grid.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

using test::Case;
using test::direction;
using test::FacetGrid;

const float cosines[] = {1.0f, 0.9f, 0.5f, 0.1f, 1e-3f, 1e-6f};
// Views for the tests that count: from above, oblique, nearly grazing, each at another azimuth.
const V3f views[] = {direction(1.0f, 0.0f), direction(0.7f, 1.0f), direction(0.3f, 2.5f),
                     direction(0.05f, -1.8f)};

class BsdfTest : public testing::TestWithParam<Case> {
 protected:
  // How far rounding may carry a density: the facet between the directions is known to an angle of 1e-7 over
  // the length of their (weighted) sum, against the width of the lobe.
  [[nodiscard]] float rounding(const V3f& wo, const V3f& wi) const {
    const Case& c = GetParam();
    const V3f sum = wi.z > 0.0f || c.eta == 0.0f ? wo + wi : wo + wi * c.eta;
    return 1e-4f + 4e-6f / (std::min(c.alpha_u, c.alpha_v) * sum.length());
  }
};

TEST_P(BsdfTest, SampleAgreesWithEvalAndPdf) {
  const Bsdf bsdf = GetParam().bsdf();
  for (const float c : cosines) {
    const V3f wo = direction(c, 0.3f);
    for (std::uint32_t i = 0; i < 500; ++i) {
      Sampler sampler(1, 2, i);
      const auto drawn = sample(bsdf, wo, sampler.next_2d());
      if (!drawn) continue;
      ASSERT_TRUE(is_finite(drawn->wi) && is_finite(drawn->weight));
      ASSERT_GT(drawn->pdf_w, 0.0f);
      ASSERT_TRUE(std::isfinite(drawn->pdf_w));
      ASSERT_NEAR(drawn->wi.length(), 1.0f, 1e-5f);
      if (drawn->is_specular) continue;
      ASSERT_FALSE(is_specular(bsdf));
      const float tolerance = rounding(wo, drawn->wi);
      if (tolerance > 0.2f) continue;  // grazing at the narrowest lobes: no digits to compare
      EXPECT_NEAR(pdf_w(bsdf, wo, drawn->wi) / drawn->pdf_w, 1.0f, tolerance);
      const C3f f = eval(bsdf, wo, drawn->wi) * (1.0f / drawn->pdf_w);
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(f[k], drawn->weight[k], tolerance * drawn->weight[k] + 1e-5f) << "from cosine " << c;
    }
  }
}

TEST_P(BsdfTest, SpecularModelsHaveNothingToEvaluate) {
  const Bsdf bsdf = GetParam().bsdf();
  if (!is_specular(bsdf)) return;
  for (const V3f& wo : views)
    for (const float z : {-0.5f, 0.5f, wo.z, -wo.z}) {
      EXPECT_TRUE(is_black(eval(bsdf, wo, direction(z, 1.0f))));
      EXPECT_EQ(pdf_w(bsdf, wo, direction(z, 1.0f)), 0.0f);
    }
}

// A model returns at most what it receives; for radiance through an interface, after undoing its compression by
// eta^2.
TEST_P(BsdfTest, ReflectsAtMostWhatArrives) {
  const Bsdf bsdf = GetParam().bsdf();
  for (const float c : cosines) {
    const V3f wo = direction(c, 0.3f);
    test::Estimate albedo;
    for (std::uint32_t i = 0; i < 4096; ++i) {
      Sampler sampler(1, 2, i);
      const auto drawn = sample(bsdf, wo, sampler.next_2d());
      albedo.add(drawn ? drawn->weight.z * drawn->eta * drawn->eta : 0.0);
    }
    EXPECT_LE(albedo.mean(), GetParam().albedo_max + 4.0 * albedo.standard_error() + 1e-4) << "cosine " << c;
  }
}

TEST_P(BsdfTest, IsReciprocal) {
  const Bsdf bsdf = GetParam().bsdf();
  for (const float a : cosines)
    for (const float b : cosines) {
      const V3f wo = direction(a, 0.3f), wi = direction(b, 2.0f);
      const C3f there = eval(bsdf, wo, wi) * wo.z, back = eval(bsdf, wi, wo) * wi.z;
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(there[k], back[k], 1e-6f + 1e-5f * back[k]);
    }
  // Where it is bright: towards sampled directions.
  for (const V3f& wo : views)
    for (std::uint32_t i = 0; i < 50; ++i) {
      Sampler sampler(5, 2, i);
      const auto drawn = sample(bsdf, wo, sampler.next_2d());
      if (!drawn || drawn->is_specular || drawn->wi.z <= 0.0f) continue;
      const C3f there = eval(bsdf, wo, drawn->wi) * wo.z, back = eval(bsdf, drawn->wi, wo) * drawn->wi.z;
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(there[k], back[k], 1e-6f + 1e-4f * back[k]);
    }
}

TEST_P(BsdfTest, IsFiniteAndNeverNegative) {
  const Bsdf bsdf = GetParam().bsdf();
  for (const float a : cosines)
    for (const float b : cosines)
      for (const float side : {1.0f, -1.0f})
        for (int k = 0; k <= 8; ++k) {
          const V3f wo = direction(a, 0.3f),
                    wi = direction(side * b, 0.3f + 0.25f * pi_f * static_cast<float>(k));
          const C3f f = eval(bsdf, wo, wi);
          const float density = pdf_w(bsdf, wo, wi);
          ASSERT_TRUE(is_finite(f) && std::isfinite(density)) << a << " " << b << " " << side << " " << k;
          ASSERT_TRUE(f.x >= 0.0f && f.y >= 0.0f && f.z >= 0.0f && density >= 0.0f);
        }
}

// Samples fall into cells all over the sphere as often as the density says; what it leaves is drawn as a Dirac
// delta or absorbed.
TEST_P(BsdfTest, DirectionsFollowTheDensity) {
  const Case& c = GetParam();
  const Bsdf bsdf = c.bsdf();
  constexpr int n = 1 << 15;
  for (const V3f& wo : views) {
    const FacetGrid grid(wo, c.alpha_u, c.alpha_v, c.eta);
    std::vector<double> seen(FacetGrid::cells + 1, 0.0), expected(FacetGrid::cells + 1, 0.0);
    grid.for_each_point(
        [&](int cell, const V3f& wi, double angle) { expected[cell] += n * angle * pdf_w(bsdf, wo, wi); });
    double total = 0.0;
    for (int i = 0; i < FacetGrid::cells; ++i) total += expected[i];
    EXPECT_LE(total, n * 1.003);
    expected.back() = std::max(0.0, n - total);
    for (std::uint32_t i = 0; i < n; ++i) {
      Sampler sampler(3, i, 0);  // independent streams: a chi-square test is not for stratified samples
      const auto drawn = sample(bsdf, wo, sampler.next_2d());
      const bool counts = drawn && !drawn->is_specular;
      seen[counts ? grid.cell_of(drawn->wi) : FacetGrid::cells] += 1.0;
    }
    if (seen.back() == n) continue;  // black or only Dirac deltas
    // The quadrature itself is good to 0.3 % of everything.
    if (expected.back() < 0.003 * n && seen.back() < 0.003 * n) expected.back() = seen.back();
    EXPECT_GT(test::chi2_test(seen, expected), 1e-5) << "from cosine " << wo.z << ", total " << total / n;
  }
}

// Weights average to the integral of eval.
TEST_P(BsdfTest, WeightsIntegrateEval) {
  const Case& c = GetParam();
  const Bsdf bsdf = c.bsdf();
  for (const V3f& wo : views) {
    const FacetGrid grid(wo, c.alpha_u, c.alpha_v, c.eta);
    double integral = 0.0;
    grid.for_each_point(
        [&](int, const V3f& wi, double angle) { integral += angle * mean_component(eval(bsdf, wo, wi)); });
    test::Estimate mean;
    for (std::uint32_t i = 0; i < 1 << 14; ++i) {
      Sampler sampler(4, i, 0);
      const auto drawn = sample(bsdf, wo, sampler.next_2d());
      mean.add(drawn && !drawn->is_specular ? mean_component(drawn->weight) : 0.0);
    }
    EXPECT_NEAR(mean.mean(), integral, 4.5 * mean.standard_error() + 0.003 * integral)
        << "from cosine " << wo.z;
  }
}

TEST_P(BsdfTest, ParametersHaveNames) {
  std::visit(
      [](const auto& model) {
        std::set<std::string> names;
        int count = 0;
        std::decay_t<decltype(model)>::visit_parameters(model, [&](std::string_view name, const auto&) {
          names.emplace(name);
          ++count;
        });
        EXPECT_EQ(static_cast<int>(names.size()), count);
      },
      GetParam().bsdf());
}

INSTANTIATE_TEST_SUITE_P(Models, BsdfTest, testing::ValuesIn(test::cases()),
                         [](const testing::TestParamInfo<Case>& model) { return model.param.name; });

TEST(Material, OneSidedIsBlackBehind) {
  const Material wall = one_sided("wall", Diffuse{C3f(0.7f)});
  EXPECT_TRUE(is_black(wall.side[back].traits().mean_diffuse_reflectance));
  EXPECT_FALSE(sample(wall.side[back].uniform(), V3f(0, 0, 1), V2f(0.5f, 0.5f)).has_value());
}

}  // namespace
}  // namespace twopass
