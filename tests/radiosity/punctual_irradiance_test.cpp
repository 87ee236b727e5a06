#include "radiosity/punctual_irradiance.h"

#include <gtest/gtest.h>

#include "radiosity/solution.h"
#include "radiosity/subdivision.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

// A floor of 2 x 2 around the origin, facing up.
SceneDescription floor_below(const PunctualLight& light) {
  SceneDescription scene;
  test::add_diffuse(scene, "floor", test::quad(V3f(-1, -1, 0), V3f(2, 0, 0), V3f(0, 2, 0)), C3f(0.5f));
  scene.punctual_lights.push_back(light);
  return scene;
}

// A room of the given size seen from inside, one corner at the origin.
SceneDescription closed_room(const V3f& size, float reflectance) {
  SceneDescription scene = test::unit_room(C3f(reflectance), C3f(0.0f), C3f(reflectance));
  for (Shape& shape : scene.shapes)
    for (V3f& p : std::get<Mesh>(shape.geometry).positions) p *= size;
  return scene;
}

std::vector<C3d> punctual_on(const Scene& scene, const ElementMesh& mesh) {
  std::uint64_t rays = 0;
  std::vector<C3d> irradiance = punctual_irradiance(scene, mesh, ElementResponse(scene, mesh), 0, rays);
  EXPECT_GT(rays, 0u);
  return irradiance;
}

// W in the first channel.
double power_on(const ElementMesh& mesh, const std::vector<C3d>& irradiance) {
  double power = 0.0;
  for (std::uint32_t i = 0; i < mesh.count(); ++i) power += mesh.area(i) * irradiance[i].x;
  return power;
}

double power_on_all(SceneDescription description, std::size_t elements) {
  const Scene scene(std::move(description));
  const ElementMesh mesh = divide_surfaces(scene, elements);
  return power_on(mesh, punctual_on(scene, mesh));
}

SpotLight spot_from_above(float cutoff_angle) {
  const M44d down(1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 1, 1);  // local +z is the world's -z
  return {light_frame(down), C3f(3.0f), cutoff_angle, 0.6f * cutoff_angle, {}};
}

// The floor is a face of a cube around the light: a sixth of all directions.
TEST(PunctualIrradiance, APointLightAboveTheMiddleOfAFloor) {
  const double truth = 3.0 * 4.0 * pi / 6.0;
  EXPECT_NEAR(power_on_all(floor_below(PointLight{V3f(0, 0, 1), C3f(3.0f)}), 200) / truth, 1.0, 2e-4);
  EXPECT_NEAR(power_on_all(floor_below(PointLight{V3f(0, 0, 1), C3f(3.0f)}), 0) / truth, 1.0, 1e-2);
}

// I cos / d^2 at the elements' middles: they are small enough for it to be the mean within 1e-3.
TEST(PunctualIrradiance, FollowsTheInverseSquareAndTheCosine) {
  const Scene scene(floor_below(PointLight{V3f(0.3f, -0.2f, 1), C3f(3.0f, 2.0f, 1.0f)}));
  const ElementMesh mesh = divide_surfaces(scene, 2000);
  const std::vector<C3d> irradiance = punctual_on(scene, mesh);
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    const V3d d = V3d(0.3f, -0.2f, 1) - mesh.patch(i).centroid().position;
    const double truth = 3.0 / std::pow(d.length(), 3);
    EXPECT_NEAR(irradiance[i].x / truth, 1.0, 3e-3);
    EXPECT_NEAR(irradiance[i].z / irradiance[i].x, 1.0 / 3.0, 1e-6);
  }
}

TEST(PunctualIrradiance, ADirectionalLightIsTheSameEverywhere) {
  const V3f down = V3f(1, 2, -2) / 3.0f;
  const Scene scene(floor_below(DirectionalLight{down, C3f(3.0f)}));
  const ElementMesh mesh = divide_surfaces(scene, 50);
  for (const C3d& irradiance : punctual_on(scene, mesh)) EXPECT_NEAR(irradiance.x, 2.0, 1e-5);
  SceneDescription from_below = floor_below(DirectionalLight{-down, C3f(3.0f)});
  const Scene dark(std::move(from_below));
  std::uint64_t rays = 0;
  for (const C3d& irradiance : punctual_irradiance(dark, mesh, ElementResponse(dark, mesh), 0, rays))
    EXPECT_EQ(irradiance, C3d(0.0));
}

TEST(PunctualIrradiance, ASpotThrowsAllOfItsPowerOntoAFloorThatHoldsItsCone) {
  const SpotLight spot = spot_from_above(0.7f);  // the tangent is 0.84
  EXPECT_NEAR(power_on_all(floor_below(spot), 800) / power(spot, 1.0), 1.0, 2e-3);
}

TEST(PunctualIrradiance, AScreenKeepsHalfOfTheLight) {
  const V3f down(0, 0, -1);
  for (const PunctualLight& light :
       {PunctualLight(PointLight{V3f(0, 0, 1), C3f(3.0f)}), PunctualLight(spot_from_above(0.7f)),
        PunctualLight(DirectionalLight{down, C3f(1.0f)})}) {
    const double whole = power_on_all(floor_below(light), 800);
    SceneDescription description = floor_below(light);
    test::add_diffuse(description, "screen", test::quad(V3f(-9, -9, 0.5f), V3f(9, 0, 0), V3f(0, 18, 0)),
                      C3f(0.0f));
    EXPECT_NEAR(power_on_all(std::move(description), 800) / whole, 0.5, 5e-3) << kind_name(light);
  }
}

// 300 lights are drawn from, and add up to one of the same power.
TEST(PunctualIrradiance, OfManyLightsSomeAreDrawn) {
  SceneDescription description = floor_below(PointLight{V3f(0, 0, 1), C3f(0.01f)});
  for (int k = 1; k < 300; ++k) description.punctual_lights.push_back(description.punctual_lights.front());
  ASSERT_GT(description.punctual_lights.size(), most_punctual_lights_asked);
  EXPECT_NEAR(power_on_all(std::move(description), 200) / (2.0 * pi / 3.0 * 3.0), 1.0, 2e-3);
}

// CIE 171:2006, 5.4: of 10,000 lm in a closed room of 4 m x 4 m x 3 m nothing is lost.
TEST(PunctualIrradiance, Cie171ConservesTheFluxOfAPointLight) {
  SceneDescription description = closed_room(V3f(4, 4, 3), 0.5f);
  description.punctual_lights.push_back(
      PointLight{V3f(2, 2, 1.5f), C3f(static_cast<float>(10000.0 / (4.0 * pi)))});
  EXPECT_NEAR(power_on_all(description, 500) / 10000.0, 1.0, 1e-4);
  description.punctual_lights = {PointLight{V3f(1, 0.5f, 2.6f), C3f(static_cast<float>(10000.0 / (4.0 * pi)))}};
  EXPECT_NEAR(power_on_all(description, 500) / 10000.0, 1.0, 5e-3);
}

// CIE 171:2006, 5.8: the mean indirect illuminance of a cube is Phi rho / (S (1 - rho)).
TEST(PunctualIrradiance, Cie171IndirectIlluminanceOfACube) {
  for (const float reflectance : {0.5f, 0.9f}) {
    SceneDescription description = closed_room(V3f(4.0f), reflectance);
    description.punctual_lights.push_back(PointLight{V3f(2.0f), C3f(static_cast<float>(10000.0 / (4.0 * pi)))});
    const Scene scene(std::move(description));
    RadiosityOptions options;
    options.max_elements = 600;
    options.relative_error = 1e-3;
    options.rays_per_element = 256;
    const Solution solution = solve_radiosity(scene, options);
    double indirect = 0.0;
    for (std::uint32_t i = 0; i < solution.mesh().count(); ++i)
      indirect += solution.mesh().area(i) * static_cast<double>(solution.irradiances()[i].indirect.x);
    const double rho = static_cast<double>(reflectance);
    EXPECT_NEAR(indirect / (10000.0 * rho / (1.0 - rho)), 1.0, 5e-3) << reflectance;
  }
}

}  // namespace
}  // namespace twopass
