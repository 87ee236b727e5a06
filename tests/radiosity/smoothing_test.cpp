#include "radiosity/smoothing.h"

#include <gtest/gtest.h>

#include "radiosity/subdivision.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

Irradiance of(float direct, float indirect) { return {C3f(direct), C3f(indirect)}; }

// A floor of three shapes side by side whose triangles differ in size, so that their grids do not match.
Scene patchwork() {
  SceneDescription scene;
  const V3f x(1, 0, 0), y(0, 1, 0);
  test::add_diffuse(scene, "small", test::quad(V3f(0.0f), x, y), C3f(0.5f));
  test::add_diffuse(scene, "large", test::quad(x, x * 9.0f, y), C3f(0.5f));
  test::add_diffuse(scene, "small again", test::quad(x * 10.0f, x, y), C3f(0.5f));
  // A wall on the left edge: not part of the floor's smooth surface.
  test::add_diffuse(scene, "wall", test::quad(V3f(0.0f), y, V3f(0, 0, 1)), C3f(0.5f));
  return Scene(std::move(scene));
}

class Floor {
 public:
  explicit Floor(const Scene& scene, std::size_t elements)
      : scene_(scene), mesh_(divide_surfaces(scene, elements)) {}

  template <class Function>
  void fill(Function function) {
    std::vector<Irradiance> irradiance;
    for (std::uint32_t i = 0; i < mesh_.count(); ++i) irradiance.push_back(function(mesh_.patch(i).centroid()));
    smooth_.emplace(mesh_, irradiance);
  }
  [[nodiscard]] double at(float x, float y) const {
    const Ray ray{V3f(x, y, 0.5f), V3f(0, 0, -1)};
    const SurfacePoint point = scene_.surface_point(ray, scene_.caster().intersect(ray));
    return smooth_->at(mesh_, mesh_.locate(point)).total().x;
  }

  [[nodiscard]] bool grids_nest() const { return divisions(1) % divisions(0) == 0; }
  [[nodiscard]] bool grids_differ() const { return divisions(0) != divisions(1); }

 private:
  [[nodiscard]] int divisions(std::uint32_t shape) const { return mesh_.roots()[2 * shape].divisions; }

  const Scene& scene_;
  ElementMesh mesh_;
  std::optional<SmoothIrradiance> smooth_;
};

TEST(Smoothing, KeepsAConstantAndStaysOnItsSurface) {
  const Scene scene = patchwork();
  Floor floor(scene, 400);
  floor.fill([](const ElementPoint& p) { return p.normal.z > 0.5 ? of(1.0f, 2.0f) : of(50.0f, 50.0f); });
  for (float x = 0.001f; x < 11.0f; x += 0.05f) EXPECT_NEAR(floor.at(x, 0.4f), 3.0, 1e-5);
}

TEST(Smoothing, IsContinuousAcrossDiagonalsShapesAndUnequalGrids) {
  const Scene scene = patchwork();
  for (const std::size_t elements : {40, 600, 2000}) {
    Floor floor(scene, elements);
    ASSERT_TRUE(floor.grids_nest() && floor.grids_differ());
    floor.fill([](const ElementPoint& p) {
      return of(float(std::sin(3.0 * p.position.x) + 2.0), float(std::cos(7.0 * p.position.y) + 1.0));
    });
    // On both sides of the seams at x = 1 and x = 10, and of the diagonals; the slope is at most about 10.
    const float step = 1e-5f;
    for (float y = 0.013f; y < 1.0f; y += 0.0317f) {
      for (const float seam : {1.0f, 10.0f})
        EXPECT_NEAR(floor.at(seam - step, y), floor.at(seam + step, y), 40.0 * step) << elements << " " << y;
      for (const float diagonal : {y, 1.0f + 9.0f * y})
        EXPECT_NEAR(floor.at(diagonal - step, y), floor.at(diagonal + step, y), 40.0 * step);
    }
  }
}

TEST(Smoothing, FollowsALinearFieldAwayFromTheBorder) {
  const Scene scene = patchwork();
  Floor floor(scene, 20000);
  floor.fill([](const ElementPoint& p) { return of(float(p.position.x), float(2.0 * p.position.y)); });
  for (float x = 2.0f; x < 9.0f; x += 0.61f) EXPECT_NEAR(floor.at(x, 0.5f), x + 1.0, 0.03);
}

TEST(Smoothing, GoesRoundASphere) {
  SceneDescription description;
  test::add_diffuse(description, "ball", Sphere{V3f(0.0f), 1.0f, false}, C3f(0.5f));
  const Scene scene(std::move(description));
  const ElementMesh mesh = divide_surfaces(scene, 200);
  std::vector<Irradiance> irradiance;
  for (std::uint32_t i = 0; i < mesh.count(); ++i)
    irradiance.push_back(of(float(mesh.patch(i).centroid().position.z), 2.0f));
  const SmoothIrradiance smooth(mesh, irradiance);
  const auto at = [&](const V3f& direction) {
    const Ray ray{direction * 2.0f, -direction};
    const SurfacePoint point = scene.surface_point(ray, scene.caster().intersect(ray));
    return smooth.at(mesh, mesh.locate(point)).total().x;
  };
  // Across the equator and the meridian x = 0, where octants meet.
  for (float a = 0.1f; a < 6.2f; a += 0.3f) {
    EXPECT_NEAR(at(V3f(std::cos(a), std::sin(a), 1e-5f).normalized()),
                at(V3f(std::cos(a), std::sin(a), -1e-5f).normalized()), 1e-3);
    EXPECT_NEAR(at(V3f(1e-5f, std::cos(a), std::sin(a)).normalized()),
                at(V3f(-1e-5f, std::cos(a), std::sin(a)).normalized()), 1e-3);
    EXPECT_NEAR(at(V3f(0.3f, std::cos(a), std::sin(a)).normalized()), 2.0 + std::sin(a) / std::sqrt(1.09), 0.1);
  }
}

}  // namespace
}  // namespace twopass
