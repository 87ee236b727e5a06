#include "materials/diffuse_response.h"

#include <gtest/gtest.h>

#include "materials/fresnel.h"

namespace twopass {
namespace {

double mean_over_even_light(const DiffuseResponse& response) {
  constexpr int steps = 10000;
  double sum = 0.0;
  for (int k = 0; k < steps; ++k) {
    const double cosine = (k + 0.5) / steps;
    sum += 2.0 * cosine * response.at(cosine) / steps;
  }
  return sum;
}

TEST(DiffuseResponse, IsEvenForLambertsModelAndForWhatDoesNotDiffuse) {
  for (const Bsdf& bsdf : {Bsdf(Diffuse{C3f(0.5f)}), Bsdf(Conductor{}), Bsdf(Diffuse{C3f(0.0f)})}) {
    const DiffuseResponse response{MaterialSide(bsdf)};
    EXPECT_TRUE(response.is_even());
    EXPECT_EQ(response.at(0.3), 1.0);
  }
}

// Of a smooth coat it is in closed form: what the coat lets through from there over what it lets through of
// even light.
TEST(DiffuseResponse, IsThatOfFresnelUnderASmoothCoat) {
  Plastic plastic;
  plastic.base_reflectance = C3f(0.2f, 0.5f, 0.9f);
  const DiffuseResponse response{MaterialSide(plastic)};
  EXPECT_FALSE(response.is_even());
  const double even = 1.0 - static_cast<double>(fresnel_diffuse_reflectance(plastic.eta));
  for (const double cosine : {0.25, 0.5, 0.75, 1.0}) {
    float refracted = 0.0f;
    const double through =
        1.0 - static_cast<double>(fresnel_dielectric(static_cast<float>(cosine), plastic.eta, refracted));
    // 33 cosines and a quadrature of the other direction.
    EXPECT_NEAR(response.at(cosine), through / even, 2e-3) << cosine;
  }
  EXPECT_GT(response.at(1.0), 1.04);
  EXPECT_LT(response.at(0.1), 0.5);
}

TEST(DiffuseResponse, IsOneOnAverageOverEvenLight) {
  RoughPlastic rough;
  rough.alpha = 0.3f;
  rough.prepare();
  const auto leaf = [](const Bsdf& bsdf) {
    return std::make_shared<const MaterialNode>(MaterialNode{TexturedModel{bsdf, {}}});
  };
  const Mixture mixture{C3f(0.5f), leaf(Diffuse{C3f(0.6f)}), leaf(rough)};
  const MaterialSide mixed(std::make_shared<const MaterialNode>(MaterialNode{mixture}));
  for (const MaterialSide& side :
       {MaterialSide(Plastic{}), MaterialSide(rough), MaterialSide(Principled{}), mixed}) {
    const DiffuseResponse response(side);
    EXPECT_FALSE(response.is_even());
    EXPECT_NEAR(mean_over_even_light(response), 1.0, 1e-4);
  }
}

}  // namespace
}  // namespace twopass
