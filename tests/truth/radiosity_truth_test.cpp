// The radiosity pass against closed forms and converged values: energy, enclosures, mirrors.
#include <gtest/gtest.h>

#include "radiosity/solution.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

constexpr FormFactorMethod methods[] = {FormFactorMethod::exact, FormFactorMethod::point,
                                        FormFactorMethod::rays};

RadiosityOptions options_for(FormFactorMethod method, std::size_t elements, std::uint32_t rays = 0) {
  RadiosityOptions options;
  options.form_factors = method;
  options.max_elements = elements;
  options.rays_per_element = rays;
  options.relative_error = 1e-7;
  return options;
}

// Mean reflected radiosity of a shape, first channel.
double mean_radiosity(const Solution& solution, std::uint32_t shape) {
  const ElementMesh& mesh = solution.mesh();
  double power = 0.0, area = 0.0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    if (mesh.root(i).shape != shape) continue;
    power += mesh.area(i) * double(mesh.reflectance(i).x) * double(solution.irradiances()[i].total().x);
    area += mesh.area(i);
  }
  return power / area;
}

double total_reflected(const Solution& solution) {
  const ElementMesh& mesh = solution.mesh();
  double power = 0.0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    power += mesh.area(i) * double(mesh.reflectance(i).x) * double(solution.irradiances()[i].total().x);
  return power;
}

// Sum A B = Sum A E / (1 - rho), whatever the mesh and the method.
TEST(RadiosityTruth, UniformAlbedoPowerBalance) {
  for (const float rho : {0.3f, 0.5f, 0.9f}) {
    const Scene scene(test::lit_cube(rho));
    for (const FormFactorMethod method : methods)
      for (const std::size_t elements : {12, 200}) {
        const Solution solution = solve_radiosity(scene, options_for(method, elements, 64));
        const double truth = rho / (1.0 - rho);
        EXPECT_NEAR(total_reflected(solution) / truth, 1.0, 2e-6) << elements;
        EXPECT_TRUE(solution.stats().closed);
      }
  }
}

// Every surface emits (1 - rho) L0: then the irradiance is pi L0 everywhere.
TEST(RadiosityTruth, Furnace) {
  const Scene scene(test::furnace_room(C3f(0.2f, 0.5f, 0.8f), 1.0f / pi_f));
  for (const FormFactorMethod method : {FormFactorMethod::exact, FormFactorMethod::rays}) {
    const Solution solution = solve_radiosity(scene, options_for(method, 300, 256));
    for (const Irradiance& irradiance : solution.irradiances())
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(irradiance.total()[c], 1.0f, method == FormFactorMethod::exact ? 1e-4 : 4e-3);
  }
}

// The furnace in a sky of radiance L0, open on one side, with a mirror and a glass ball: still L0 everywhere.
TEST(RadiosityTruth, OpenFurnaceWithMirrorAndGlass) {
  SceneDescription description = test::unit_room(C3f(0.5f), C3f(0.0f), C3f(0.5f));
  for (Shape& shape : description.shapes) shape.radiance[front] = C3f(0.5f / pi_f);
  Conductor mirror;
  mirror.eta = C3f(0.0f);
  description.materials.push_back(one_sided("mirror", mirror));
  description.shapes[2].material = static_cast<std::uint32_t>(description.materials.size() - 1);
  description.shapes[2].radiance[front] = C3f(0.0f);
  description.materials.push_back(interface_material("glass", Dielectric{}));
  description.shapes[1] = {
      "ball", Sphere{V3f(0.5f), 0.3f, false}, static_cast<std::uint32_t>(description.materials.size() - 1), {}};
  description.environment = Environment(C3f(1.0f / pi_f));
  const Scene scene(std::move(description));
  const Solution solution = solve_radiosity(scene, options_for(FormFactorMethod::rays, 100, 1 << 14));
  double mean = 0.0;
  for (const Irradiance& irradiance : solution.irradiances()) {
    EXPECT_NEAR(irradiance.total().x, 1.0f, 0.1f);
    mean += double(irradiance.total().x) / double(solution.irradiances().size());
  }
  EXPECT_NEAR(mean, 1.0, 2e-3);
}

// Converged means of the unit cube with a ceiling of exitance 1; errors must fall by 3.4 to 4 as elements
// halve.
TEST(RadiosityTruth, CubeConvergesAtTheRightRate) {
  const Scene scene(test::lit_cube(0.5f));
  const double wall = 0.181105, floor = 0.171216, ceiling = 1.104362 - 1.0;
  double previous = 0.0;
  for (const std::size_t elements : {12, 48, 192, 768}) {
    const Solution solution = solve_radiosity(scene, options_for(FormFactorMethod::exact, elements));
    const double error = mean_radiosity(solution, 0) - floor;
    if (elements == 192 || elements == 768) {
      EXPECT_GT(previous / error, 3.0) << elements;
      EXPECT_LT(previous / error, 4.6) << elements;
    }
    previous = error;
    if (elements != 768) continue;
    EXPECT_NEAR(mean_radiosity(solution, 0), floor, 2e-4);
    EXPECT_NEAR(mean_radiosity(solution, 1), ceiling, 4e-4);
    for (std::uint32_t w = 2; w < 6; ++w) EXPECT_NEAR(mean_radiosity(solution, w), wall, 2e-4);
  }
  const Solution rays = solve_radiosity(scene, options_for(FormFactorMethod::rays, 3000, 512));
  EXPECT_NEAR(mean_radiosity(rays, 0), floor, 4e-4);
  EXPECT_NEAR(mean_radiosity(rays, 1), ceiling, 4e-4);
  EXPECT_NEAR(mean_radiosity(rays, 2), wall, 4e-4);
}

TEST(RadiosityTruth, CubeOfHighReflectance) {
  const Scene scene(test::lit_cube(0.8f));
  const Solution solution = solve_radiosity(scene, options_for(FormFactorMethod::exact, 768));
  EXPECT_NEAR(mean_radiosity(solution, 1), 0.58751, 1.5e-3);
  EXPECT_NEAR(mean_radiosity(solution, 2), 0.68788, 1e-3);
  EXPECT_NEAR(mean_radiosity(solution, 0), 0.66098, 1e-3);
}

TEST(RadiosityTruth, CubeWithABlackLamp) {
  const Scene scene(test::unit_room(C3f(0.5f), C3f(1.0f / pi_f), C3f(0.0f)));
  for (const FormFactorMethod method : {FormFactorMethod::exact, FormFactorMethod::rays}) {
    const Solution solution = solve_radiosity(scene, options_for(method, 800, 1024));
    EXPECT_NEAR(mean_radiosity(solution, 0), 0.155175, 4e-4);
    EXPECT_NEAR(mean_radiosity(solution, 2), 0.163992, 4e-4);
  }
}

TEST(RadiosityTruth, PlatesInTheOpen) {
  const Scene scene(test::plates(1.0f, 0.5f));
  for (const FormFactorMethod method : {FormFactorMethod::exact, FormFactorMethod::rays}) {
    const Solution solution = solve_radiosity(scene, options_for(method, 400, 4096));
    EXPECT_NEAR(mean_radiosity(solution, 0), 0.0102181, 1e-4);
    EXPECT_NEAR(mean_radiosity(solution, 1), 0.1009472, 1e-4);
    EXPECT_FALSE(solution.stats().closed);
  }
}

// B1 = 10/9 with its own exitance, B2 = 2/9; by rays, five standard deviations of what 4e6 rays can tell.
TEST(RadiosityTruth, ConcentricSpheres) {
  const Scene scene(test::concentric_spheres(0.5f));
  const Solution solution = solve_radiosity(scene, options_for(FormFactorMethod::rays, 1000, 1 << 12));
  EXPECT_NEAR(mean_radiosity(solution, 0), 1.0 / 9.0, 1e-3);
  EXPECT_NEAR(mean_radiosity(solution, 1), 2.0 / 9.0, 1e-3);
  EXPECT_TRUE(solution.stats().closed);
}

// H = <E> / (1 - <rho>) for any emission and reflectance inside a sphere: here one octant emits.
TEST(RadiosityTruth, InsideOfASphere) {
  SceneDescription description;
  test::add_diffuse(description, "ball", Sphere{V3f(3.0f, -2.0f, 1.0f), 2.0f, true}, C3f(0.8f),
                    C3f(1.0f / pi_f));
  const Scene scene(std::move(description));
  for (const FormFactorMethod method : {FormFactorMethod::exact, FormFactorMethod::rays}) {
    const Solution solution = solve_radiosity(scene, options_for(method, 200, 1024));
    EXPECT_NEAR(mean_radiosity(solution, 0), 0.8 / 0.2, 0.02);
  }
}

// A perfect mirror at x = 0 makes the unit cube half of a box of two units, lit by all of its ceiling.
TEST(RadiosityTruth, MirrorDoublesTheRoom) {
  SceneDescription description = test::lit_cube(0.5f);
  Conductor mirror;
  mirror.eta = C3f(0.0f);
  description.materials.push_back(one_sided("mirror", mirror));
  description.shapes[2].material = static_cast<std::uint32_t>(description.materials.size() - 1);
  const Scene scene(std::move(description));
  for (const FormFactorMethod method : {FormFactorMethod::exact, FormFactorMethod::rays}) {
    const Solution solution = solve_radiosity(scene, options_for(method, 1000, 2048));
    // About five standard deviations of two million paths from the lamp, and the elements' size.
    EXPECT_NEAR(mean_radiosity(solution, 1), 0.12036, 1e-3);
    EXPECT_NEAR(mean_radiosity(solution, 0), 0.230122, 1e-3);
    EXPECT_NEAR(mean_radiosity(solution, 3), 0.212382, 1e-3);
    EXPECT_NEAR(mean_radiosity(solution, 4), 0.218567, 1e-3);
    EXPECT_NEAR(mean_radiosity(solution, 5), 0.218567, 1e-3);
  }
}

// Power neither appears nor vanishes: what is absorbed is what is emitted, in a room full of everything.
TEST(RadiosityTruth, AbsorbedPowerIsEmittedPower) {
  const Scene scene(test::lit_room());
  const Solution solution = solve_radiosity(scene, options_for(FormFactorMethod::rays, 4000, 512));
  const ElementMesh& mesh = solution.mesh();
  double direct = 0.0, absorbed = 0.0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    direct += mesh.area(i) * double(solution.irradiances()[i].direct.x);
    absorbed +=
        mesh.area(i) * (1.0 - double(mesh.reflectance(i).x)) * double(solution.irradiances()[i].total().x);
  }
  EXPECT_NEAR(direct, 1.0, 3e-3);  // 16 W/m2 from 1/16 m2
  // The rest falls back onto the black lamp: about the lamp's share of the surface over that of all absorption.
  EXPECT_LT(absorbed, 1.0);
  EXPECT_GT(absorbed, 0.95);
}

TEST(RadiosityTruth, UnitsOfLengthDoNotMatter) {
  SceneDescription description = test::lit_room();
  const Scene original(description);
  const Solution metres = solve_radiosity(original, options_for(FormFactorMethod::rays, 400, 256));
  for (Shape& shape : description.shapes)
    for (V3f& p : std::get<Mesh>(shape.geometry).positions) p *= 1024.0f;
  const Scene scaled(std::move(description));
  const Solution large = solve_radiosity(scaled, options_for(FormFactorMethod::rays, 400, 256));
  for (std::size_t i = 0; i < metres.irradiances().size(); ++i)
    EXPECT_FLOAT_EQ(metres.irradiances()[i].total().x, large.irradiances()[i].total().x);
}

}  // namespace
}  // namespace twopass
