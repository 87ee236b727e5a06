// Every material in uniform light: what loses nothing is invisible, what loses something shows its albedo, and
// a closed textured furnace has the same radiance everywhere, whichever numbers the paths are drawn from.
#include <random>

#include <gtest/gtest.h>

#include "integrators/make_integrator.h"
#include "radiosity/solution.h"
#include "tests/materials/cases.h"
#include "tests/support/scenes.h"
#include "tests/support/statistics.h"

namespace twopass {
namespace {

constexpr SamplerKind sampler_kinds[] = {SamplerKind::sobol, SamplerKind::independent, SamplerKind::stratified};
constexpr float l0 = 2.0f;

// The mean radiance of rays from `origin` into a cone. One stream holds 16 samples, so that each kind of
// numbers spreads them as it would those of a pixel; streams are independent, so that the standard error is
// honest.
test::Estimate mean_in_cone(const Integrator& integrator, SamplerKind kind, const V3f& origin, const V3f& axis,
                            float cos_half_angle, std::uint32_t streams) {
  constexpr std::uint32_t in_stream = 16;
  const Frame frame(axis.normalized());
  test::Estimate estimate;
  std::vector<PathSample> samples;
  RayCounts counts;
  for (std::uint32_t stream = 0; stream < streams; ++stream) {
    samples.clear();
    for (std::uint32_t i = 0; i < in_stream; ++i) {
      Sampler sampler(7, stream, i, kind, in_stream);
      const V2f u = sampler.next_2d();
      const float z = 1.0f - u.x * (1.0f - cos_half_angle), r = std::sqrt(std::max(0.0f, 1.0f - z * z));
      const V3f w = frame.to_world({r * std::cos(2 * pi_f * u.y), r * std::sin(2 * pi_f * u.y), z});
      samples.push_back({{origin, w}, sampler});
    }
    integrator.trace(samples, counts);
    double sum = 0.0;
    for (const PathSample& sample : samples) sum += mean_component(sample.seen.radiance);
    estimate.add(sum / in_stream);
  }
  return estimate;
}

Texture board(float color0, float color1, float squares) {
  return Checkerboard{C3f(color0), C3f(color1), {squares, 0, 0, 0, squares, 0}};
}

MaterialSide mixed(const Texture& weight, const MaterialSide& first, const MaterialSide& second) {
  return MaterialSide(
      std::make_shared<const MaterialNode>(MaterialNode{Mixture{weight, first.node(), second.node()}}));
}

// ---------------------------------------------------------------------------------------------------------
// The open furnace: a sphere in a constant environment.

struct Lossless {
  std::string name;
  Material material;
  bool is_exact;  // each path alone returns all of the light
  bool is_held_by_solution = true;
};
void PrintTo(const Lossless& c, std::ostream* out) { *out << c.name; }

Material both_sides(const MaterialSide& side) { return two_sided("test", side, side); }

std::vector<Lossless> lossless_materials() {
  const MaterialSide white = Diffuse{C3f(1.0f)}, mirror = Conductor{}, nothing = Null{};
  const MaterialSide pane = ThinDielectric{};
  return {
      {"mirror", both_sides(mirror), true},
      {"glass", material_of("glass", Dielectric{}), true},
      {"dense_glass", material_of("glass", Dielectric{2.4f}), true},
      {"bubble", material_of("bubble", Dielectric{1.0f / 1.5f}), true},
      {"pane", both_sides(pane), true},
      {"null", both_sides(nothing), true},
      {"white", both_sides(white), false},
      {"mirror_with_holes", both_sides(mixed(board(0.0f, 1.0f, 8.0f), nothing, mirror)), true},
      {"mirror_half_there", both_sides(mixed(C3f(0.6f), nothing, mirror)), true},
      {"white_with_holes", both_sides(mixed(board(0.0f, 1.0f, 8.0f), nothing, white)), false, false},
      {"white_half_there", both_sides(mixed(C3f(0.6f), nothing, white)), false, false},
      {"white_and_mirror", both_sides(mixed(board(0.2f, 0.9f, 5.0f), white, mirror)), false},
      {"pane_mirror_and_holes", both_sides(mixed(C3f(0.5f), mixed(C3f(0.3f), pane, mirror), nothing)), true},
  };
}

SceneDescription ball_in_the_sky(const Material& material) {
  SceneDescription scene;
  scene.environment = Environment(C3f(l0));
  scene.materials.push_back(material);
  Shape ball;
  ball.name = "ball";
  ball.geometry = Sphere{V3f(0.0f), 1.0f, false};
  scene.shapes.push_back(ball);
  return scene;
}

// The ball fills the cone but for a rim.
test::Estimate look_at_ball(const Integrator& integrator, SamplerKind kind, std::uint32_t streams) {
  return mean_in_cone(integrator, kind, V3f(0.4f, -2.9f, 0.7f), V3f(-0.4f, 2.9f, -0.7f), 0.94f, streams);
}

// Roulette at high survival only: paths caught between two mirrors end some day.
constexpr PathLimits long_paths{-1, 200, false};

class OpenFurnaceTest : public testing::TestWithParam<Lossless> {};

TEST_P(OpenFurnaceTest, WhatLosesNothingIsInvisible) {
  const Scene scene(ball_in_the_sky(GetParam().material));
  RadiosityOptions options;
  options.max_elements = 200;
  options.rays_per_element = 256;
  const Solution solution = solve_radiosity(scene, options);
  for (const IntegratorKind integrator_kind : {IntegratorKind::path, IntegratorKind::two_pass}) {
    // The solution lets no light through holes: what it holds of the inside of a white mask is too dark.
    if (integrator_kind == IntegratorKind::two_pass && !GetParam().is_held_by_solution) continue;
    const auto integrator = make_integrator(integrator_kind, scene, {&solution}, long_paths);
    for (const SamplerKind kind : sampler_kinds) {
      const test::Estimate e = look_at_ball(*integrator, kind, 500);
      EXPECT_NEAR(e.mean(), l0, 4.4 * e.standard_error() + 2e-5 * l0) << int(kind);  // level 1e-5 a mean
      EXPECT_LT(e.standard_error(), GetParam().is_exact ? 2e-5 : 0.02);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Materials, OpenFurnaceTest, testing::ValuesIn(lossless_materials()),
                         [](const testing::TestParamInfo<Lossless>& model) { return model.param.name; });

// Single scattering between facets loses some light, and never gains any.
TEST(OpenFurnace, RoughMirrorsAndRoughGlassLoseLittle) {
  RoughConductor metal;
  RoughDielectric glass;
  for (const Microfacet distribution : {Microfacet::beckmann, Microfacet::ggx}) {
    metal.distribution = glass.distribution = distribution;
    for (const Material& material : {both_sides(metal), material_of("ground", glass)}) {
      const Scene scene(ball_in_the_sky(material));
      const auto path = make_integrator(IntegratorKind::path, scene, {}, long_paths);
      for (const SamplerKind kind : sampler_kinds) {
        const test::Estimate e = look_at_ball(*path, kind, 1000);
        EXPECT_LT(e.mean(), l0 + 4.4 * e.standard_error());
        EXPECT_GT(e.mean(), 0.85 * l0);
      }
    }
  }
}

// ---------------------------------------------------------------------------------------------------------
// The closed furnace.

// The unit room with walls of two albedos that emit what they do not reflect, square by square.
SceneDescription textured_furnace(bool with_objects) {
  const float a0 = 0.9f, a1 = 0.3f, squares = 3.0f;
  SceneDescription scene = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
  const auto emission = std::make_shared<const Texture>(board((1 - a0) * l0, (1 - a1) * l0, squares));
  const MaterialSide wall(std::make_shared<const MaterialNode>(
      MaterialNode{TexturedModel{Diffuse{}, {{0, board(a0, a1, squares)}}}}));
  for (Shape& shape : scene.shapes) {
    std::get<Mesh>(shape.geometry).uvs = {V2f(0, 0), V2f(1, 0), V2f(1, 1), V2f(0, 1)};
    scene.materials[shape.material] = one_sided("board", wall);
    shape.radiance[front] = mean_color(*emission);
    shape.radiance_texture = emission;
  }
  if (!with_objects) return scene;
  test::add_box(scene, "mirror", V3f(0.1f, 0.5f, 0.1f), V3f(0.3f, 0.7f, 0.5f),
                one_sided("mirror", Conductor{}));
  test::add_diffuse(scene, "glass", Sphere{V3f(0.7f, 0.5f, 0.3f), 0.2f, false}, C3f(0.0f));
  scene.materials.back() = interface_material("glass", Dielectric{});
  test::add_diffuse(scene, "bubble", Sphere{V3f(0.3f, 0.4f, 0.75f), 0.15f, false}, C3f(0.0f));
  scene.materials.back() = material_of("bubble", ThinDielectric{});
  test::add_box(scene, "mask", V3f(0.6f, 0.1f, 0.6f), V3f(0.8f, 0.3f, 0.9f),
                both_sides(mixed(C3f(0.6f), MaterialSide(Null{}), MaterialSide(Conductor{}))));
  return scene;
}

TEST(ClosedFurnace, TexturedWallsAndLosslessObjectsAreAllTheSame) {
  for (const bool with_objects : {false, true}) {
    const Scene scene(textured_furnace(with_objects));
    const auto path = make_integrator(IntegratorKind::path, scene, {}, {});
    for (const SamplerKind kind : sampler_kinds) {
      const test::Estimate e = mean_in_cone(*path, kind, V3f(0.5f, 0.3f, 0.5f), V3f(0, 1, 0), -1.0f, 400);
      EXPECT_NEAR(e.mean(), l0, 4.4 * e.standard_error() + 1e-5) << with_objects << int(kind);
      EXPECT_LT(e.standard_error(), 0.02);
    }
  }
}

// The solution holds the mean emission of an element: it cannot follow squares finer than its elements.
TEST(ClosedFurnace, TwoPassFollowsTheTexture) {
  const Scene scene(textured_furnace(true));
  RadiosityOptions options;
  options.max_elements = 1500;
  options.relative_error = 1e-5;
  const Solution solution = solve_radiosity(scene, options);
  const auto two_pass = make_integrator(IntegratorKind::two_pass, scene, {&solution}, {});
  for (const SamplerKind kind : sampler_kinds) {
    const test::Estimate e = mean_in_cone(*two_pass, kind, V3f(0.5f, 0.3f, 0.5f), V3f(0, 1, 0), -1.0f, 500);
    EXPECT_NEAR(e.mean(), l0, 4.4 * e.standard_error() + 0.01);
  }
}

// With the same albedo a everywhere, what has at most n edges is 1 - a^n of all.
TEST(ClosedFurnace, DepthIsAGeometricSeries) {
  const float albedo = 0.6f;
  const Scene scene(test::furnace_room(C3f(albedo), l0));
  for (const int depth : {1, 2, 3, 5, 8}) {
    const auto path = make_integrator(IntegratorKind::path, scene, {}, {depth, 4, false});
    for (const SamplerKind kind : sampler_kinds) {
      const test::Estimate e = mean_in_cone(*path, kind, V3f(0.5f, 0.3f, 0.5f), V3f(0, 1, 0), -1.0f, 400);
      EXPECT_NEAR(e.mean(), l0 * (1.0 - std::pow(double(albedo), depth)), 4.4 * e.standard_error() + 1e-5)
          << depth;
    }
  }
  const auto direct = make_integrator(IntegratorKind::direct, scene, {}, {});
  const test::Estimate e =
      mean_in_cone(*direct, SamplerKind::sobol, V3f(0.5f, 0.3f, 0.5f), V3f(0, 1, 0), -1.0f, 400);
  EXPECT_NEAR(e.mean(), l0 * (1.0 - double(albedo) * albedo), 4.4 * e.standard_error() + 1e-5);
}

// ---------------------------------------------------------------------------------------------------------
// One bounce: light sampled and light met by chance, weighed together, add up to the albedo.

std::vector<test::Case> models() {
  std::vector<test::Case> all = test::cases();
  Principled metal, coat, glass, satin;
  metal.metallic = 1.0f;
  metal.roughness = 0.3f;
  metal.anisotropic = 0.8f;
  coat.clearcoat = 1.0f;
  coat.clearcoat_gloss = 0.9f;
  glass.spec_trans = 1.0f;
  glass.roughness = 0.3f;
  satin.sheen = 1.0f;
  satin.flatness = 0.5f;
  satin.spec_trans = 0.3f;
  all.push_back({"principled_metal", metal});
  all.push_back({"principled_coat", coat});
  all.push_back({"principled_glass", glass});
  all.push_back({"principled_inside", glass.from_behind()});
  all.push_back({"principled_satin", satin});
  PrincipledThin leaf;
  leaf.spec_trans = 0.4f;
  leaf.diff_trans = 1.2f;
  all.push_back({"principled_thin", leaf});
  return all;
}

class OneBounceTest : public testing::TestWithParam<test::Case> {};

// What the model returns of light 1 from everywhere, by drawing directions from it alone.
test::Estimate albedo(const Bsdf& bsdf, const V3f& wo, int samples) {
  std::mt19937 generator(5);
  const auto next = [&] { return static_cast<float>(generator() >> 8) * 0x1p-24f; };
  test::Estimate estimate;
  for (int i = 0; i < samples; ++i) {
    const float u = next(), v = next();
    const std::optional<BsdfSample> drawn = sample(bsdf, wo, V2f(u, v));
    estimate.add(drawn ? mean_component(drawn->weight) : 0.0);
  }
  return estimate;
}

TEST_P(OneBounceTest, PathSeesTheAlbedo) {
  SceneDescription plate;
  test::add_diffuse(plate, "plate", test::quad(V3f(-1, -1, 0), V3f(2, 0, 0), V3f(0, 2, 0)), C3f(0.0f));
  std::get<Mesh>(plate.shapes[0].geometry).uvs = {V2f(0, 0), V2f(1, 0), V2f(1, 1), V2f(0, 1)};
  const Bsdf bsdf = GetParam().bsdf();
  plate.materials[0] = one_sided("plate", MaterialSide(bsdf));
  SceneDescription in_sky = plate, in_lamp = plate;
  in_sky.environment = Environment(C3f(1.0f));
  test::add_diffuse(in_lamp, "lamp", Sphere{V3f(0.0f), 10.0f, true}, C3f(0.0f), C3f(1.0f));
  // Two lights at two angles of every model: all together err once in 1e4.
  const double level = test::sidak(1e-4, 4 * models().size());
  for (const SceneDescription& description : {in_sky, in_lamp}) {
    const Scene scene(description);
    const PathLimits two_edges{2, 5, false};
    const auto path = make_integrator(IntegratorKind::path, scene, {}, two_edges);
    for (const float height : {2.0f, 0.6f}) {
      const V3f origin(-0.3f, 0.9f, height), axis = V3f(0.1f, 0.2f, 0.0f) - origin;
      const Ray ray{origin, axis.normalized()};
      const SurfacePoint point = scene.surface_point(ray, scene.caster().intersect(ray));
      const test::Estimate truth = albedo(bsdf, point.shading.to_local(-ray.direction), 8000),
                           seen = mean_in_cone(*path, SamplerKind::independent, origin, axis, 1.0f, 500);
      const double error = std::hypot(truth.standard_error(), seen.standard_error());
      const double difference = std::max(0.0, std::abs(seen.mean() - truth.mean()) - 2e-5);
      EXPECT_TRUE(difference == 0.0 || test::two_sided_p(difference / error) > level)
          << seen.mean() << " +- " << seen.standard_error() << ", albedo " << truth.mean() << " +- "
          << truth.standard_error();
      EXPECT_LT(error, 0.02);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, OneBounceTest, testing::ValuesIn(models()),
                         [](const testing::TestParamInfo<test::Case>& model) { return model.param.name; });

}  // namespace
}  // namespace twopass
