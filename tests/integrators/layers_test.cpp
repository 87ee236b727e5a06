// Light sorted into layers: it adds up to the picture in every integrator, and each layer holds what it says.
#include <gtest/gtest.h>

#include "integrators/make_integrator.h"
#include "integrators/sample_layers.h"
#include "radiosity/guide.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

constexpr IntegratorKind all_kinds[] = {IntegratorKind::path, IntegratorKind::direct, IntegratorKind::two_pass,
                                        IntegratorKind::unbiased, IntegratorKind::radiosity};

// A room with two lamps and a point light; with a mirror, a glass ball, a glossy and a coated floor tile if
// wanted.
SceneDescription room(bool only_diffuse) {
  SceneDescription scene = test::unit_room(C3f(0.7f, 0.6f, 0.5f), C3f(0.0f), C3f(0.7f));
  test::add_diffuse(scene, "key", test::quad(V3f(0.35f, 0.35f, 0.999f), V3f(0, 0.3f, 0), V3f(0.3f, 0, 0)),
                    C3f(0.0f), C3f(10.0f, 8.0f, 6.0f));
  test::add_diffuse(scene, "fill", test::quad(V3f(0.001f, 0.4f, 0.3f), V3f(0, 0.3f, 0), V3f(0, 0, 0.3f)),
                    C3f(0.2f), C3f(1.0f, 2.0f, 4.0f));
  scene.punctual_lights.push_back(PointLight{V3f(0.8f, 0.2f, 0.7f), C3f(0.05f)});
  scene.punctual_light_groups = {"spark"};
  if (only_diffuse) return scene;
  const auto add = [&](const std::string& name, Geometry geometry, const Bsdf& bsdf) {
    test::add_diffuse(scene, name, std::move(geometry), C3f(0.0f));
    scene.materials.back() = material_of(name, bsdf);
  };
  const auto tile = [](float x, float y) {
    return test::quad(V3f(x, y, 0.002f), V3f(0.4f, 0, 0), V3f(0, 0.4f, 0));
  };
  RoughPlastic coated{1.49f, C3f(0.4f, 0.2f, 0.1f), C3f(1.0f), 0.2f, Microfacet::ggx, false};
  coated.prepare();
  add("mirror", test::quad(V3f(0.2f, 0.99f, 0.2f), V3f(0.6f, 0, 0), V3f(0, 0, 0.6f)), Conductor{});
  add("ball", Sphere{V3f(0.7f, 0.6f, 0.2f), 0.15f}, Dielectric{});
  add("glossy", tile(0.05f, 0.1f), Phong{C3f(0.4f), C3f(0.4f), 20.0f});
  add("coated", tile(0.5f, 0.1f), coated);
  add("plastic", tile(0.05f, 0.55f), Plastic{});
  return scene;
}

// Everything that integrators want, and rays from a corner of the room that see all of it.
struct LitRoom {
  explicit LitRoom(SceneDescription description)
      : scene(std::move(description)),
        groups(scene.description()),
        solution(solve_radiosity(scene, options())),
        field(scene, solution),
        guide(scene, solution),
        grouped(scene, solution, solve_by_group(scene, groups, solution, options()), true) {}

  static RadiosityOptions options() {
    RadiosityOptions radiosity;
    radiosity.max_elements = 2000;
    return radiosity;
  }
  [[nodiscard]] std::unique_ptr<Integrator> integrator(IntegratorKind kind,
                                                       const PathLimits& limits = {}) const {
    return make_integrator(kind, scene, {&solution, &field, &guide}, limits);
  }
  static std::vector<PathSample> rays(std::uint32_t count, std::uint32_t seed) {
    std::vector<PathSample> samples;
    for (std::uint32_t i = 0; i < count; ++i) {
      Sampler sampler(seed, i, 0);
      const V2f u = sampler.next_2d();
      const V3f direction(2.0f * u.x - 1.0f, 1.0f, 2.8f * u.y - 2.2f);
      samples.push_back({{V3f(0.5f, 0.02f, 0.6f), unit(direction)}, sampler});
    }
    return samples;
  }

  Scene scene;
  LightGroups groups;
  Solution solution;
  IndirectField field;
  Guide guide;
  GroupedLight grouped;
};

struct Traced {
  std::vector<PathSample> samples;
  std::vector<SampleLayers> layers;
  std::vector<C3f> group_values;
};

Traced trace(const LitRoom& setup, const Integrator& integrator, std::uint32_t count, std::uint32_t seed) {
  Traced t{LitRoom::rays(count, seed), std::vector<SampleLayers>(count), {}};
  const std::size_t groups = setup.groups.size();
  t.group_values.resize(count * groups);
  for (std::size_t i = 0; i < count; ++i) {
    t.layers[i].groups = std::span(t.group_values).subspan(i * groups, groups);
    t.layers[i].light_groups = &setup.groups;
    t.layers[i].cached = &setup.grouped;
    t.samples[i].layers = &t.layers[i];
  }
  RayCounts counts;
  integrator.trace(t.samples, counts);
  return t;
}

C3f of(const SampleLayers& layers, LightClass kind) { return layers.light[static_cast<std::size_t>(kind)]; }

const LitRoom& furnished() {
  static const LitRoom setup(room(false));
  return setup;
}

TEST(Layers, SumToThePictureInEveryIntegratorAndChangeNothingOfIt) {
  const LitRoom& setup = furnished();
  ASSERT_EQ(setup.groups.names(), (std::vector<std::string>{"key", "fill", "spark"}));
  for (const PathLimits& limits : {PathLimits{}, PathLimits{.clamp_direct = 2.0f, .clamp_indirect = 0.5f}})
    for (const IntegratorKind kind : all_kinds) {
      const std::unique_ptr<Integrator> integrator = setup.integrator(kind, limits);
      std::vector<PathSample> plain = LitRoom::rays(3000, 5);
      RayCounts counts;
      integrator->trace(plain, counts);
      const Traced traced = trace(setup, *integrator, 3000, 5);
      for (std::size_t i = 0; i < plain.size(); ++i) {
        const C3f radiance = traced.samples[i].seen.radiance;
        ASSERT_EQ(radiance, plain[i].seen.radiance) << "layers change the picture";
        C3f sum(0.0f), of_groups(0.0f);
        float size = 0.0f;  // what is added may cancel, in `unbiased`
        for (const C3f& c : traced.layers[i].light) {
          sum += c;
          size += max_abs_component(c);
        }
        for (const C3f& c : traced.layers[i].groups) {
          of_groups += c;
          size += max_abs_component(c);
        }
        ASSERT_LE(max_abs_component(sum - radiance), 2e-6f * size) << "by class, integrator " << int(kind);
        ASSERT_LE(max_abs_component(of_groups - radiance), 2e-6f * size)
            << "by group, integrator " << int(kind);
      }
    }
}

// The paths of at most two edges are the same, number by number, in both integrators.
TEST(Layers, DirectLightIsThatOfTheIntegratorOfDirectLight) {
  const LitRoom& setup = furnished();
  const Traced path = trace(setup, *setup.integrator(IntegratorKind::path), 5000, 6);
  std::vector<PathSample> direct = LitRoom::rays(5000, 6);
  RayCounts counts;
  setup.integrator(IntegratorKind::direct)->trace(direct, counts);
  std::array<int, light_class_count> seen{};
  for (std::size_t i = 0; i < direct.size(); ++i) {
    const SampleLayers& layers = path.layers[i];
    const C3f sum = of(layers, LightClass::emission) + of(layers, LightClass::diffuse_direct) +
                    of(layers, LightClass::specular_direct) + of(layers, LightClass::transmission_direct);
    ASSERT_LE(max_abs_component(sum - direct[i].seen.radiance), 2e-6f * max_abs_component(sum));
    for (std::size_t k = 0; k < light_class_count; ++k) seen[k] += is_black(layers.light[k]) ? 0 : 1;
  }
  for (std::size_t k = 0; k < light_class_count; ++k)
    if (k != static_cast<std::size_t>(LightClass::background) &&
        k != static_cast<std::size_t>(LightClass::transmission_direct)) {
      EXPECT_GT(seen[k], 50) << "the test must meet light of class " << k;
    }
}

// Where the solution is looked up the split is the path tracer's, too.
TEST(Layers, TheSplitSurvivesTheCache) {
  const LitRoom& setup = furnished();
  constexpr std::uint32_t count = 60000;
  const auto estimates = [&](IntegratorKind kind, std::uint32_t seed) {
    const Traced traced = trace(setup, *setup.integrator(kind), count, seed);
    std::array<test::Estimate, light_class_count> result;
    for (const SampleLayers& layers : traced.layers)
      for (std::size_t k = 0; k < light_class_count; ++k) result[k].add(mean_component(layers.light[k]));
    return result;
  };
  const auto truth = estimates(IntegratorKind::path, 1);
  double all = 0.0;
  for (const test::Estimate& e : truth) all += e.mean();
  for (const IntegratorKind kind : {IntegratorKind::two_pass, IntegratorKind::unbiased}) {
    const auto ours = estimates(kind, 2);
    for (std::size_t k = 0; k < light_class_count; ++k)
      // Level 1e-5 a class; and half a percent of the picture for the elements.
      EXPECT_NEAR(ours[k].mean(), truth[k].mean(),
                  4.4 * std::hypot(ours[k].standard_error(), truth[k].standard_error()) + 0.005 * all)
          << "class " << k << ", integrator " << int(kind);
  }
}

// Where diffuse reflection is looked up, the coat alone is traced: what comes over it is specular.
TEST(Layers, WhatACoatShowsThatIsTracedAloneIsSpecular) {
  SceneDescription description = room(true);
  RoughPlastic coated{1.49f, C3f(0.3f, 0.2f, 0.1f), C3f(1.0f), 0.2f, Microfacet::ggx, false};
  coated.prepare();
  description.materials[0] = one_sided("walls", coated);
  const LitRoom setup(std::move(description));
  const auto indirect_light = [&](IntegratorKind kind, std::uint32_t seed) {
    test::Estimate estimate;
    const Traced traced = trace(setup, *setup.integrator(kind), 60000, seed);
    for (const SampleLayers& layers : traced.layers)
      estimate.add(mean_component(of(layers, LightClass::specular_indirect)));
    return estimate;
  };
  const test::Estimate truth = indirect_light(IntegratorKind::path, 1);
  const test::Estimate ours = indirect_light(IntegratorKind::two_pass, 2);
  ASSERT_GT(truth.mean(), 20.0 * truth.standard_error());
  EXPECT_NEAR(ours.mean(), truth.mean(),
              4.4 * std::hypot(ours.standard_error(), truth.standard_error()) + 0.01 * truth.mean());
}

// The bare solution knows direct and indirect light as well; all of it where surfaces are diffuse.
TEST(Layers, TheViewOfASolutionIsSplit) {
  const LitRoom setup(room(true));
  const auto indirect_light = [&](IntegratorKind kind) {
    test::Estimate estimate;
    const Traced traced = trace(setup, *setup.integrator(kind), 60000, 3);
    for (const SampleLayers& layers : traced.layers)
      estimate.add(mean_component(of(layers, LightClass::diffuse_indirect)));
    return estimate.mean();
  };
  const double truth = indirect_light(IntegratorKind::path);
  EXPECT_NEAR(indirect_light(IntegratorKind::radiosity), truth, 0.1 * truth);
}

// A group is what there is when the other lights are off.
TEST(Layers, LightGroupsAreThePicturesOfTheirLights) {
  const LitRoom setup(room(true));
  constexpr std::uint32_t count = 30000;
  for (const IntegratorKind kind : {IntegratorKind::path, IntegratorKind::two_pass, IntegratorKind::unbiased}) {
    const Traced all = trace(setup, *setup.integrator(kind), count, 1);
    for (std::uint32_t g = 0; g < setup.groups.size(); ++g) {
      const Scene lit(setup.groups.lit_by(setup.scene.description(), g));
      std::vector<PathSample> alone = LitRoom::rays(count, 2);
      RayCounts counts;
      make_integrator(IntegratorKind::path, lit, {}, {})->trace(alone, counts);
      for (int c = 0; c < 3; ++c) {
        test::Estimate of_group, truth;
        for (std::size_t i = 0; i < count; ++i) {
          of_group.add(all.layers[i].groups[g][c]);
          truth.add(alone[i].seen.radiance[c]);
        }
        // Level 1e-5; half a percent for the elements.
        EXPECT_NEAR(of_group.mean(), truth.mean(),
                    4.4 * std::hypot(of_group.standard_error(), truth.standard_error()) + 0.005 * truth.mean())
            << setup.groups.names()[g] << " channel " << c << ", integrator " << int(kind);
      }
    }
  }
}

TEST(Layers, DiffuseAndSpecularPartsAreThoseOfTheModelWithoutTheOther) {
  const auto floor = [](const Bsdf& bsdf) {
    SceneDescription scene = test::unit_room(C3f(0.5f), C3f(1.0f), C3f(0.0f));
    scene.materials[scene.shapes[0].material] = material_of("floor", bsdf);
    return scene;
  };
  const auto look_down = [](const Scene& scene, std::uint32_t seed) {
    std::vector<PathSample> samples;
    for (std::uint32_t i = 0; i < 40000; ++i) {
      Sampler sampler(seed, i, 0);
      samples.push_back({{V3f(0.5f, 0.1f, 0.5f), unit(V3f(0.0f, 0.6f, -0.5f))}, sampler});
    }
    std::vector<SampleLayers> layers(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i].layers = &layers[i];
    RayCounts counts;
    make_integrator(IntegratorKind::path, scene, {}, {})->trace(samples, counts);
    std::array<test::Estimate, light_class_count> result;
    for (const SampleLayers& l : layers)
      for (std::size_t k = 0; k < light_class_count; ++k) result[k].add(l.light[k].x);
    return result;
  };
  const Scene both(floor(Phong{C3f(0.3f), C3f(0.5f), 20.0f})), matt(floor(Diffuse{C3f(0.3f)})),
      shiny(floor(Phong{C3f(0.0f), C3f(0.5f), 20.0f}));
  const auto of_both = look_down(both, 1), of_matt = look_down(matt, 2), of_shiny = look_down(shiny, 3);
  // Direct light only: indirect light changes when the floor does.
  for (const auto& [kind, truth] :
       {std::pair{LightClass::diffuse_direct, &of_matt}, {LightClass::specular_direct, &of_shiny}}) {
    const auto k = static_cast<std::size_t>(kind);
    EXPECT_LT(std::abs(test::z_score(of_both[k], (*truth)[k])), 4.4) << k;
    EXPECT_GT((*truth)[k].mean(), 10.0 * (*truth)[k].standard_error());
  }
  EXPECT_EQ(of_matt[static_cast<std::size_t>(LightClass::specular_direct)].mean(), 0.0);
}

TEST(Layers, FirstSurfaceHasItsDataAndHolesAreNone) {
  SceneDescription description = room(true);
  test::add_diffuse(description, "hole", test::quad(V3f(0, 0.5f, 0), V3f(1, 0, 0), V3f(0, 0, 1)), C3f(0.0f));
  description.materials.back() = {"hole", {MaterialSide(Null{}), MaterialSide(Null{})}};
  const Scene scene(std::move(description));
  Sampler sampler(1, 0, 0);
  // Not onto the diagonal of the wall, of which points are kept clear.
  PathSample sample{{V3f(0.4f, 0.1f, 0.5f), V3f(0, 1, 0)}, sampler};
  SampleLayers layers;
  sample.layers = &layers;
  RayCounts counts;
  make_integrator(IntegratorKind::path, scene, {}, {})->trace({&sample, 1}, counts);
  ASSERT_TRUE(layers.first.is_there);
  EXPECT_NEAR((layers.first.point.position - V3f(0.4f, 1.0f, 0.5f)).length(), 0.0f, 1e-6f);
  EXPECT_NEAR(layers.first.distance, 0.9f, 5e-6f) << "but for the step behind the hole";
  EXPECT_EQ(layers.first.albedo, C3f(0.7f, 0.6f, 0.5f));
  EXPECT_EQ(layers.first.point.geometric_normal, V3f(0, -1, 0));

  sample = {{V3f(0.5f, 0.1f, 0.5f), unit(V3f(0, -0.1f, -1))}, sampler};
  sample.ray.origin = V3f(0.5f, 0.1f, 5.0f);
  sample.ray.direction = V3f(0, 0, 1);
  sample.layers = &layers;
  make_integrator(IntegratorKind::path, scene, {}, {})->trace({&sample, 1}, counts);
  EXPECT_FALSE(layers.first.is_there) << "of an earlier sample";
}

TEST(Layers, BackgroundAndTransmission) {
  SceneDescription description;
  test::add_diffuse(description, "pane", test::quad(V3f(-1, -1, 0), V3f(2, 0, 0), V3f(0, 2, 0)), C3f(0.0f));
  description.materials.back() = material_of("pane", Bsdf(ThinDielectric{}));
  description.environment = Environment(C3f(2.0f));
  const Scene scene(std::move(description));
  const std::unique_ptr<Integrator> path = make_integrator(IntegratorKind::path, scene, {}, {});
  test::Estimate transmitted, reflected;
  RayCounts counts;
  for (std::uint32_t i = 0; i < 4000; ++i) {
    SampleLayers layers;
    PathSample sample{{V3f(0, 0, 1), V3f(0, 0, -1)}, Sampler(1, i, 0)};
    sample.layers = &layers;
    path->trace({&sample, 1}, counts);
    transmitted.add(of(layers, LightClass::transmission_direct).x);
    reflected.add(of(layers, LightClass::specular_direct).x);
    EXPECT_TRUE(is_black(of(layers, LightClass::background)));
    sample.ray = {V3f(0, 0, 1), V3f(0, 0, 1)};
    path->trace({&sample, 1}, counts);
    EXPECT_EQ(of(layers, LightClass::background), C3f(2.0f));
  }
  // Normal incidence on two interfaces: 2 r / (1 + r), r = ((n - 1) / (n + 1))^2.
  const double n = 1.5046 / 1.000277, r = std::pow((n - 1) / (n + 1), 2), both = 2 * r / (1 + r);
  EXPECT_NEAR(reflected.mean(), 2.0 * both, 4.4 * reflected.standard_error());
  EXPECT_NEAR(transmitted.mean(), 2.0 * (1.0 - both), 4.4 * transmitted.standard_error());
}

}  // namespace
}  // namespace twopass
