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
