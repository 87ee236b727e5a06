#include "materials/fresnel.h"

#include <gtest/gtest.h>

namespace twopass {
namespace {

TEST(Fresnel, NormalIncidenceOnGlass) {
  float cos_t;
  // CIE 171:2006, case 5.5: n = 1.52 reflects 0.04258.
  EXPECT_NEAR(fresnel_dielectric(1.0f, 1.52f, cos_t), 0.0425800f, 1e-6f);
  EXPECT_FLOAT_EQ(cos_t, 1.0f);
}

TEST(Fresnel, EqualIndicesReflectNothingAtAnyAngle) {
  float cos_t;
  for (const float c : {1.0f, 0.5f, 0.01f}) EXPECT_NEAR(fresnel_dielectric(c, 1.0f, cos_t), 0.0f, 1e-6f);
}

TEST(Fresnel, BrewsterAngleHalvesTheFormula) {
  // At tan(theta) = eta the parallel part vanishes; the perpendicular one is ((1 - eta^2) / (1 + eta^2))^2.
  const float eta = 1.5f, cos_i = 1.0f / std::sqrt(1.0f + eta * eta);
  const float s = (1.0f - eta * eta) / (1.0f + eta * eta);
  float cos_t;
  EXPECT_NEAR(fresnel_dielectric(cos_i, eta, cos_t), 0.5f * s * s, 1e-6f);
}

TEST(Fresnel, TotalInternalReflectionBeyondTheCriticalAngle) {
  const float eta = 1.0f / 1.5f;
  const float critical = std::sqrt(1.0f - eta * eta);
  float cos_t;
  EXPECT_EQ(fresnel_dielectric(0.99f * critical, eta, cos_t), 1.0f);
  EXPECT_LT(fresnel_dielectric(1.01f * critical, eta, cos_t), 1.0f);
}

TEST(Fresnel, BothDirectionsThroughAnInterfaceReflectTheSame) {
  for (float c = 0.05f; c <= 1.0f; c += 0.05f) {
    float cos_t, cos_back;
    const float there = fresnel_dielectric(c, 1.5f, cos_t);
    EXPECT_NEAR(fresnel_dielectric(cos_t, 1.0f / 1.5f, cos_back), there, 2e-5f);
    EXPECT_NEAR(cos_back, c, 2e-5f);
  }
}

TEST(Fresnel, ConductorWithoutExtinctionIsADielectric) {
  float cos_t;
  for (float c = 0.05f; c <= 1.0f; c += 0.05f)
    EXPECT_NEAR(fresnel_conductor(c, C3f(1.5f), C3f(0.0f)).x, fresnel_dielectric(c, 1.5f, cos_t), 2e-6f);
}

TEST(Fresnel, ConductorAtNormalIncidence) {
  // ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2)
  const float eta = 0.2f, k = 3.0f;
  const float expected = ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k);
  EXPECT_NEAR(fresnel_conductor(1.0f, C3f(eta), C3f(k)).y, expected, 1e-6f);
}

TEST(Fresnel, IdealMirrorReflectsAllAtEveryAngle) {
  for (float c = 0.0f; c <= 1.0f; c += 0.125f)
    EXPECT_NEAR(fresnel_conductor(c, C3f(0.0f), C3f(1.0f)).z, 1.0f, 1e-5f);
}

}  // namespace
}  // namespace twopass
