#include "materials/scattering_block.h"

#include <random>

#include <gtest/gtest.h>

#include "tests/materials/cases.h"

namespace twopass {
namespace {

RoughPlastic plastic(float alpha, const C3f& base, const C3f& specular, bool nonlinear) {
  RoughPlastic model{1.3f + alpha, base, specular, alpha, Microfacet::ggx, nonlinear};
  model.prepare();
  return model;
}

// Models with lanes and without, alike and not; two that have nothing to draw from their coat, or from
// anything.
std::vector<Bsdf> models() {
  std::vector<Bsdf> models;
  for (const test::Case& c : test::cases()) models.push_back(c.bsdf());
  for (const float alpha : {1e-5f, 0.05f, 0.1f, 0.4f, 1.0f})
    for (const bool nonlinear : {false, true})
      models.push_back(plastic(alpha, C3f(0.8f, 0.3f, 0.1f), C3f(1.0f, 0.5f, 0.2f), nonlinear));
  models.push_back(plastic(0.2f, C3f(0.5f), C3f(0.0f), true));
  models.push_back(plastic(0.2f, C3f(0.0f), C3f(0.0f), false));
  return models;
}

TEST(ScatteringBlock, SaysToTheBitWhatEachModelSaysAlone) {
  const std::vector<Bsdf> all = models();
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  const auto u = [&] { return V2f(uniform(random), uniform(random)); };
  ScatteringBlock block;
  int with_lanes = 0, absorbed = 0, below = 0;
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::size_t> points;
    std::array<const Bsdf*, block_size> bsdf;
    std::array<V3f, block_size> wo, wi;
    std::array<V2f, block_size> numbers;
    for (std::size_t k = 0; k < block_size; ++k) {
      if (uniform(random) * 32.0f > static_cast<float>(round % 33)) continue;
      points.push_back(k);
      bsdf[k] = &all[random() % all.size()];
      wo[k] = square_to_cosine_hemisphere(u());
      wi[k] = round % 3 == 0 ? unit(square_to_sphere(u()) * 0.01f - V3f(wo[k].x, wo[k].y, -wo[k].z))
                             : square_to_sphere(u());
      numbers[k] = u();
    }
    block.reset(
        points, [&](std::size_t k) -> const Bsdf& { return *bsdf[k]; }, [&](std::size_t k) { return wo[k]; });
    for (const std::size_t k : points) block.set_wi(k, wi[k]);
    block.evaluate();
    for (const std::size_t k : points) {
      const auto* rough = std::get_if<RoughPlastic>(bsdf[k]);
      ASSERT_EQ(block.has(k), rough && rough->distribution == Microfacet::ggx);
      if (!block.has(k)) continue;
      ++with_lanes;
      below += wi[k].z < 0.0f;
      const BsdfValue alone = evaluate(*rough, wo[k], wi[k]), value = block.value(k);
      ASSERT_EQ(value.value, alone.value);
      ASSERT_EQ(value.pdf_w, alone.pdf_w);
    }
    for (const std::size_t k : points) block.set_u(k, numbers[k]);
    block.sample();
    for (const std::size_t k : points) {
      if (!block.has(k)) continue;
      const auto alone = sample(*bsdf[k], wo[k], numbers[k]), drawn = block.drawn(k);
      ASSERT_EQ(drawn.has_value(), alone.has_value());
      absorbed += !alone;
      if (!alone) continue;
      ASSERT_EQ(drawn->wi, alone->wi);
      ASSERT_EQ(drawn->weight, alone->weight);
      ASSERT_EQ(drawn->pdf_w, alone->pdf_w);
    }
  }
  EXPECT_GT(with_lanes, 1000);
  EXPECT_GT(absorbed, 100);
  EXPECT_GT(below, 1000);
}

}  // namespace
}  // namespace twopass
