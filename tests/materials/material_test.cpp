// Trees of materials: textures in place of parameters, mixtures, masks, perturbed normals.
#include "materials/material.h"

#include <gtest/gtest.h>

#include "render/core/sampler.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

MaterialNodePtr node_of(MaterialNode node) { return std::make_shared<const MaterialNode>(std::move(node)); }
MaterialNodePtr model(const Bsdf& bsdf, std::vector<TextureBinding> textures = {}) {
  return node_of({TexturedModel{bsdf, std::move(textures)}});
}

// A 2x2 image: 0.1 0.2 / 0.3 0.4, grey.
Bitmap small_bitmap() {
  auto image = std::make_shared<Image>(2, 2, std::vector<std::string>{"R", "G", "B"});
  for (int i = 0; i < 4; ++i)
    for (int c = 0; c < 3; ++c)
      image->pixels[static_cast<std::size_t>(3 * i + c)] = 0.1f * static_cast<float>(i + 1);
  return Bitmap{std::make_shared<TextureImage>(*image)};
}

TEST(MaterialSide, OneModelIsUniform) {
  const MaterialSide side(model(Diffuse{C3f(0.3f)}));
  EXPECT_TRUE(side.is_uniform());
  EXPECT_EQ(std::get<Diffuse>(side.uniform()).reflectance, C3f(0.3f));
  EXPECT_EQ(side.traits().mean_diffuse_reflectance, C3f(0.3f));
  EXPECT_FALSE(side.traits().needs_uv);
  EXPECT_TRUE(MaterialSide(RoughConductor{}).traits().needs_uv);  // it has a direction
}

TEST(MaterialSide, TexturesReplaceParameters) {
  const MaterialSide side(model(Diffuse{}, {{0, small_bitmap()}}));
  ASSERT_FALSE(side.is_uniform());
  EXPECT_TRUE(side.traits().needs_uv);
  EXPECT_FALSE(side.traits().needs_choice);
  ShadingGeometry at;
  at.uv = V2f(0.75f, 0.25f);  // the centre of the second texel of the first row
  EXPECT_FLOAT_EQ(std::get<Diffuse>(side.resolve(at, 0.0f)).reflectance.x, 0.2f);
  EXPECT_FLOAT_EQ(side.traits().mean_diffuse_reflectance.x, 0.25f);
  EXPECT_FLOAT_EQ(side.diffuse_reflectance(at.uv).x, 0.2f);
}

// (M28): over u, mixtures of mixtures come up as often as their weights say.
TEST(MaterialSide, MixturesAreChosenByTheirWeights) {
  const MaterialNodePtr inner =
      node_of({Mixture{C3f(0.25f), model(Diffuse{C3f(1, 0, 0)}), model(Conductor{})}});
  const MaterialSide side(node_of({Mixture{C3f(0.4f), model(Null{}), inner}}));
  EXPECT_TRUE(side.traits().needs_choice && side.traits().may_be_specular && !side.traits().is_specular);
  EXPECT_FLOAT_EQ(side.traits().mean_diffuse_reflectance.x, 0.4f * 0.75f);
  EXPECT_FLOAT_EQ(side.transparency(V2f(0, 0)), 0.6f);
  int count[3] = {};
  constexpr int n = 10000;
  for (int i = 0; i < n; ++i) {
    ShadingGeometry at;
    const Bsdf bsdf = side.resolve(at, (static_cast<float>(i) + 0.5f) / n);
    ++count[std::holds_alternative<Null>(bsdf) ? 0 : std::holds_alternative<Diffuse>(bsdf) ? 1 : 2];
  }
  EXPECT_NEAR(count[0], 0.6 * n, 1);
  EXPECT_NEAR(count[1], 0.4 * 0.75 * n, 2);
  EXPECT_NEAR(count[2], 0.4 * 0.25 * n, 2);
}

TEST(MaterialSide, BacksBelongToTheirFronts) {
  const Material glass = material_of("glass", MaterialSide(Dielectric{1.5f, C3f(1.0f), C3f(1.0f)}));
  EXPECT_FLOAT_EQ(std::get<Dielectric>(glass.side[back].uniform()).eta, 1.0f / 1.5f);
  const Material wall = material_of("wall", MaterialSide(model(Diffuse{}, {{0, small_bitmap()}})));
  EXPECT_EQ(wall.side[back].traits().mean_diffuse_reflectance, C3f(0.0f));
  const MaterialSide mask(node_of({Mixture{C3f(0.5f), model(Null{}), model(Diffuse{})}}));
  EXPECT_FLOAT_EQ(material_of("mask", mask).side[back].transparency(V2f(0, 0)), 0.5f);
}

// (M29): the slope of the heights is the slope of the surface.
TEST(MaterialSide, BumpsTurnTheNormalByTheirSlope) {
  Bitmap ramp = small_bitmap();
  const MaterialSide side(node_of({BumpMap{ramp, 2.0f, {}, model(Diffuse{})}}));
  ShadingGeometry at;
  at.frame = Frame(V3f(0, 0, 1));
  at.frame.s = V3f(1, 0, 0), at.frame.t = V3f(0, 1, 0);
  at.uv = V2f(0.5f, 0.5f);
  static_cast<void>(side.resolve(at, 0.0f));
  // Between the texels the height rises by .1 a texel along u, .2 along v; a texel is half a unit.
  const V3f expected = unit(V3f(-2.0f * 0.2f, -2.0f * 0.4f, 1.0f));
  EXPECT_NEAR((at.frame.n - expected).length(), 0.0f, 1e-6f);
  EXPECT_NEAR(at.frame.n.dot(at.frame.s), 0.0f, 1e-6f);
  EXPECT_GT(at.terminator, 0.0f);

  // Seen from behind, a hill is a hollow: the same surface, the opposite normal.
  ShadingGeometry behind;
  behind.wo = V3f(0, 0, -1);
  behind.frame = Frame(V3f(0, 0, -1));
  behind.uv = at.uv;
  behind.is_back = true;
  static_cast<void>(side.resolve(behind, 0.0f));
  EXPECT_NEAR((behind.frame.n + expected).length(), 0.0f, 1e-6f);
}

TEST(MaterialSide, NormalsNeverFaceAwayFromTheViewer) {
  for (std::uint32_t i = 0; i < 1000; ++i) {
    Sampler sampler(1, i, 0);
    const V2f u = sampler.next_2d(), v = sampler.next_2d();
    const MaterialSide side(node_of({NormalMap{C3f(u.x, u.y, 0.5f + 0.5f * v.x), {}, model(Diffuse{})}}));
    ShadingGeometry at;
    at.frame = Frame(V3f(0, 0, 1));
    const float z = std::max(v.y, 1e-4f), r = std::sqrt(1.0f - z * z);
    at.wo = V3f(r, 0, z);
    static_cast<void>(side.resolve(at, 0.0f));
    ASSERT_GT(at.frame.n.dot(at.wo), 0.0f);
    ASSERT_NEAR(at.frame.n.length(), 1.0f, 1e-5f);
  }
}

// (M30)
TEST(SoftTerminator, FadesFromAboveToTheHorizon) {
  EXPECT_EQ(soft_terminator(0.0f, 0.3f), 1.0f);
  EXPECT_FLOAT_EQ(soft_terminator(1.0f, 1.0f), 1.0f);
  EXPECT_FLOAT_EQ(soft_terminator(1.0f, std::sqrt(0.5f)), 2.0f / (1.0f + std::sqrt(2.0f)));
  EXPECT_LT(soft_terminator(1.0f, 1e-4f), 1e-3f);
}

// From Rec.709 to AP1, about.
const ColorMatrix to_ap1{
    {C3f(0.613f, 0.070f, 0.021f), C3f(0.340f, 0.916f, 0.110f), C3f(0.047f, 0.014f, 0.869f)}};

void expect_near(const C3f& a, const C3f& b) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-5f * std::max(1.0f, std::abs(b[c])));
}

TEST(Primaries, ColoursChangeAndNumbersDoNot) {
  const C3f color(0.6f, 0.1f, 0.3f);
  Image image(1, 1, {"R", "G", "B"});
  image.pixels = {color.x, color.y, color.z};
  const Texture texture = scaled(Bitmap{std::make_shared<TextureImage>(image)}, {C3f(0.5f), C3f(0.1f)});
  RoughPlastic plastic;
  std::size_t diffuse = 0, alpha = 0, number = 0;
  RoughPlastic::visit_parameters(plastic, [&](std::string_view name, const auto&) {
    if (name == "diffuse_reflectance") diffuse = number;
    if (name == "alpha") alpha = number;
    ++number;
  });
  const MaterialSide side(model(plastic, {{diffuse, texture}, {alpha, texture}}));
  const MaterialSide changed =
      in_primaries(Material{"a", {side, MaterialSide(Diffuse{color})}}, to_ap1).side[front];
  ShadingGeometry at;
  const auto before = std::get<RoughPlastic>(side.resolve(at, 0.0f)),
             after = std::get<RoughPlastic>(changed.resolve(at, 0.0f));
  expect_near(after.base_reflectance, to_ap1(color * 0.5f + C3f(0.1f)));
  EXPECT_EQ(before.alpha, after.alpha);
  EXPECT_EQ(before.eta, after.eta);
  const Material plain = in_primaries(one_sided("b", Diffuse{color}), to_ap1);
  expect_near(std::get<Diffuse>(plain.side[front].uniform()).reflectance, to_ap1(color));
}

TEST(Primaries, MetalsKeepTheirColour) {
  Conductor gold;
  gold.eta = C3f(0.143f, 0.375f, 1.442f);
  gold.k = C3f(3.983f, 2.386f, 1.603f);
  gold.specular_reflectance = C3f(0.9f, 0.5f, 0.7f);
  const auto changed = std::get<Conductor>(in_primaries(one_sided("gold", gold), to_ap1).side[front].uniform());
  const C3f straight = fresnel_conductor(1.0f, gold.eta, gold.k);
  expect_near(changed.specular_reflectance * fresnel_conductor(1.0f, changed.eta, changed.k),
              to_ap1(gold.specular_reflectance * straight));
}

TEST(Primaries, WhatTheyCannotShowIsZero) {
  const ColorMatrix narrow{{C3f(1.2f, -0.1f, 0.0f), C3f(-0.2f, 1.1f, 0.0f), C3f(0.0f, 0.0f, 1.0f)}};
  EXPECT_EQ(narrow(C3f(1.0f, 0.0f, 0.5f)).y, 0.0f);
}

}  // namespace
}  // namespace twopass
