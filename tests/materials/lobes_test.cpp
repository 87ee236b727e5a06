#include "materials/lobes.h"

#include <gtest/gtest.h>

#include "render/core/sampler.h"
#include "render/core/warp.h"
#include "tests/materials/cases.h"

namespace twopass {
namespace {

std::vector<test::Case> all_cases() {
  std::vector<test::Case> all = test::cases();
  Principled mixed{C3f(0.8f, 0.4f, 0.1f), 0.4f};
  mixed.metallic = 0.3f;
  mixed.spec_trans = 0.4f;
  mixed.sheen = 0.5f;
  mixed.clearcoat = 1.0f;
  all.push_back({"principled", mixed});
  PrincipledThin sheet{C3f(0.8f, 0.4f, 0.1f), 0.4f};
  sheet.spec_trans = 0.3f;
  sheet.diff_trans = 0.7f;
  sheet.sheen = 0.5f;
  all.push_back({"principledthin", sheet});
  return all;
}

TEST(Lobes, TheDiffusePartIsAPartAndItsShareIsBetweenNothingAndAll) {
  for (const test::Case& c : all_cases()) {
    const Bsdf bsdf = c.bsdf();
    for (std::uint32_t i = 0; i < 500; ++i) {
      Sampler sampler(3, i, 0);
      const V3f wo = square_to_cosine_hemisphere(sampler.next_2d());
      if (!(wo.z > 0.0f)) continue;
      const V3f wi = square_to_sphere(sampler.next_2d());
      const C3f all = eval(bsdf, wo, wi), diffuse = eval_diffuse(bsdf, wo, wi),
                share = diffuse_share(bsdf, wo, wi);
      for (int k = 0; k < 3; ++k) {
        ASSERT_GE(diffuse[k], 0.0f) << c.name;
        ASSERT_LE(diffuse[k], all[k] * 1.00001f) << c.name;
        ASSERT_TRUE(share[k] >= 0.0f && share[k] <= 1.0f) << c.name;
      }
      ASSERT_TRUE(wi.z >= 0.0f || is_black(diffuse)) << c.name;
    }
  }
}

// Integrated over all directions, the diffuse lobes return what the radiosity solution is told of them.
TEST(Lobes, DiffuseLobesIntegrateToTheDiffuseReflectance) {
  for (const test::Case& c : all_cases()) {
    const Bsdf bsdf = c.bsdf();
    C3d sum(0.0);
    constexpr std::uint32_t n = 20000;
    for (std::uint32_t i = 0; i < n; ++i) {
      Sampler sampler(4, i, 0);
      const V3f wo = square_to_cosine_hemisphere(sampler.next_2d()),
                wi = square_to_cosine_hemisphere(sampler.next_2d());
      if (wo.z > 0.0f && wi.z > 0.0f) sum += C3d(eval_diffuse(bsdf, wo, wi)) * (pi / wi.z);
    }
    const C3f truth = diffuse_reflectance(bsdf);
    // The models' own averages are fits, good to some 2 %.
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(sum[k] / n, truth[k], 0.03 * truth[k] + 1e-9) << c.name << " " << k;
  }
}

// As seen from one direction, wherever there is a closed form: the integral over the other, by 4000 cosines.
TEST(Lobes, DiffuseAlbedosAreTheIntegralsOfTheDiffuseLobes) {
  int known = 0;
  for (const test::Case& c : all_cases())
    for (const float z : {0.1f, 0.5f, 0.98f}) {
      const V3f wo(std::sqrt(1.0f - z * z), 0.0f, z);
      const auto albedo = diffuse_albedo(c.bsdf(), wo);
      if (!albedo) continue;
      ++known;
      C3d sum(0.0);
      constexpr int n = 4000;
      for (int i = 0; i < n; ++i) {
        const float cosine = std::sqrt((static_cast<float>(i) + 0.5f) / n);
        sum += C3d(eval_diffuse(c.bsdf(), wo, V3f(std::sqrt(1.0f - cosine * cosine), 0.0f, cosine))) *
               (pi / static_cast<double>(cosine));
      }
      for (int k = 0; k < 3; ++k) EXPECT_NEAR((*albedo)[k], sum[k] / n, 2e-3) << c.name << " " << z;
    }
  EXPECT_GT(known, 30);
}

// Without its diffuse lobes a model says what it says without their part, has none, and draws with the density
// that it states: by 20,000 drawn directions, each weighted, against as many over the sphere.
TEST(Lobes, WithoutDiffuseLobesTheOthersAreLeft) {
  for (const test::Case& c : all_cases()) {
    if (is_specular(c.bsdf())) continue;
    const Bsdf rest = without_diffuse(c.bsdf());
    EXPECT_EQ(diffuse_reflectance(rest), C3f(0.0f)) << c.name;
    for (std::uint32_t i = 0; i < 500; ++i) {
      Sampler sampler(5, i, 0);
      const V3f wo = square_to_cosine_hemisphere(sampler.next_2d());
      if (!(wo.z > 0.0f)) continue;
      const V3f wi = square_to_sphere(sampler.next_2d());
      const C3f all = eval(c.bsdf(), wo, wi), expected = all - eval_diffuse(c.bsdf(), wo, wi),
                left = eval(rest, wo, wi);
      for (int k = 0; k < 3; ++k)
        ASSERT_NEAR(left[k], expected[k], 1e-5f * all[k] + 1e-7f) << c.name << " " << i;
      const auto drawn = sample(rest, wo, sampler.next_2d());
      if (!drawn || drawn->is_specular || drawn->pdf_w > 1e4f) continue;  // where the angle is lost in rounding
      const BsdfValue at = visit_model(rest, [&](const auto& model) { return evaluate(model, wo, drawn->wi); });
      ASSERT_NEAR(drawn->pdf_w, at.pdf_w, 2e-3f * at.pdf_w) << c.name << " " << i;
      for (int k = 0; k < 3; ++k)
        ASSERT_NEAR(drawn->weight[k] * drawn->pdf_w, at.value[k], 2e-3f * at.value[k] + 1e-6f)
            << c.name << " " << i;
    }
  }
}

TEST(Lobes, AlbedosOfKnownSurfaces) {
  EXPECT_EQ(albedo(Diffuse{C3f(0.1f, 0.5f, 0.9f)}), C3f(0.1f, 0.5f, 0.9f));
  EXPECT_EQ(albedo(Conductor{}), C3f(1.0f));
  EXPECT_NEAR(albedo(Dielectric{}).x, 1.0f, 1e-6f);
  EXPECT_EQ(albedo(Principled{.base_color = C3f(0.8f, 0.4f, 0.1f), .metallic = 1.0f}), C3f(0.8f, 0.4f, 0.1f));
  for (const test::Case& c : all_cases()) {
    const C3f color = albedo(c.bsdf());
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(color[k] >= 0.0f && color[k] <= 1.0f) << c.name;
  }
}

}  // namespace
}  // namespace twopass
