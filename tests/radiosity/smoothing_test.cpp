#include "radiosity/smoothing.h"

#include <gtest/gtest.h>

#include "radiosity/subdivision.h"
#include "tests/radiosity/test_scenes.h"
#include "tests/radiosity/walls.h"

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
    return smooth_->at(mesh_.locate(point)).total().x;
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
  for (float x = 0.001f; x < 11.0f; x += 0.05f) EXPECT_EQ(floor.at(x, 0.4f), 3.0);
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
    return smooth.at(mesh.locate(point)).total().x;
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

// A wall in the plane z = 0 with a value between 0 and 1 on each element, at random unless told.
class Wall {
 public:
  Wall(const Scene& scene, ElementMesh mesh) : scene_(scene), mesh_(std::move(mesh)), vertices_(mesh_) {
    std::vector<Irradiance> irradiance;
    for (std::uint32_t i = 0; i < mesh_.count(); ++i)
      irradiance.push_back(of(Sampler(5, i, 0).next_1d(), 0.0f));
    smooth_.emplace(mesh_, irradiance);
  }

  [[nodiscard]] double at(const V3d& p) const {
    const Ray ray{V3f(p) + V3f(0, 0, 0.5f), V3f(0, 0, -1)};
    const SurfacePoint point = scene_.surface_point(ray, scene_.caster().intersect(ray));
    return smooth_->at(mesh_.locate(point)).total().x;
  }

  // The largest jump between the two sides of any edge of any face, 1e-6 away from it; on the border of the
  // wall there is only one side.
  [[nodiscard]] double largest_jump() const {
    double worst = 0.0;
    for (const auto& corner : vertices_.faces().corner)
      for (int k = 0; k < 3; ++k) {
        const V3d a(vertices_.position(corner[k])), b(vertices_.position(corner[(k + 1) % 3]));
        const V3d across = V3d(0, 0, 1).cross(b - a).normalized() * 1e-6;
        for (const double t : {0.013, 0.26, 0.49, 0.62, 0.88}) {
          const V3d p = a + (b - a) * t, lo = p - across, hi = p + across;
          if (std::min({lo.x, lo.y, hi.x, hi.y}) <= 0.0 || std::max({lo.x, lo.y, hi.x, hi.y}) >= 1.0) continue;
          worst = std::max(worst, std::abs(at(lo) - at(hi)));
        }
      }
    return worst;
  }
  [[nodiscard]] const VertexMesh& vertices() const { return vertices_; }

 private:
  const Scene& scene_;
  ElementMesh mesh_;
  VertexMesh vertices_;
  std::optional<SmoothIrradiance> smooth_;
};

Scene wall_scene(std::span<const float> cut, float jitter) {
  SceneDescription scene;
  test::add_diffuse(scene, "wall", test::wall(cut, jitter), C3f(0.5f));
  return Scene(std::move(scene));
}

constexpr float uneven[] = {0.0f, 0.22f, 0.4f, 0.7f, 1.0f};

// Grids that nest and grids that do not, quad-trees without balance on both, and clusters among them.
TEST(Smoothing, IsContinuousAcrossTJunctionsOfEveryKind) {
  const Scene scene = wall_scene(uneven, 0.3f);
  const std::vector<std::uint16_t> kinds[] = {
      {1}, {1, 3, 6}, {1, 2, 4}, {3, 1, 6, 1, 12}, {5, 4, 3, 1, 2}, {0, 0, 0, 1, 3, 6}};
  for (const std::vector<std::uint16_t>& divisions : kinds)
    for (const int splits : {0, 2}) {
      const ElementMesh coarse = test::mesh_of_divisions(scene, divisions, 2);
      const Wall wall(scene, test::split_at_random(coarse, splits, 0.3f));
      EXPECT_EQ(wall.vertices().hanging().empty(), divisions.size() == 1 && splits == 0);
      EXPECT_LT(wall.largest_jump(), 1e-4 * 2.5) << divisions.size() << " " << splits;
    }
}

TEST(Smoothing, IsContinuousOnWhatTheProgramMakesOfAFineWall) {
  const Scene scene = wall_scene(test::even_cuts(40), 0.3f);
  for (const std::size_t elements : {60, 700, 2400, 9000}) {
    const ElementMesh mesh = divide_surfaces(scene, elements);
    const Wall wall(scene, mesh);
    EXPECT_EQ(mesh.cluster_count() > 0, elements < 9000);
    EXPECT_LT(wall.largest_jump(), 2.5e-4) << elements;
  }
}

// Equal on all elements: exactly that; else never beyond the values of the elements.
TEST(Smoothing, KeepsConstantsToTheBitAndNeverOvershoots) {
  const Scene scene = wall_scene(uneven, 0.3f);
  const std::uint16_t divisions[] = {0, 0, 0, 1, 3, 6};
  const ElementMesh mesh = test::split_at_random(test::mesh_of_divisions(scene, divisions, 2), 3, 0.3f);
  const VertexMesh vertices(mesh);
  const float third = 1.0f / 3.0f;
  const std::vector<Irradiance> constant(mesh.count(), of(third, 0.1f));
  for (const Irradiance& value : vertex_irradiance(vertices, mesh, constant)) {
    EXPECT_EQ(value.direct, C3f(third));
    EXPECT_EQ(value.indirect, C3f(0.1f));
  }
  const SmoothIrradiance smooth(mesh, constant);
  for (std::uint32_t k = 0; k < 1000; ++k) {
    const V2f u = Sampler(1, k, 0).next_2d();
    EXPECT_EQ(smooth.at({k % static_cast<std::uint32_t>(mesh.count()), 0, u.x, u.y}).direct, C3f(third));
  }
  std::vector<Irradiance> ends(mesh.count(), of(0.2f, 0.0f));
  for (std::size_t i = 0; i < ends.size(); i += 3) ends[i] = of(0.7f, 0.0f);
  for (const Irradiance& value : vertex_irradiance(vertices, mesh, ends)) {
    EXPECT_GE(value.direct.x, 0.2f);
    EXPECT_LE(value.direct.x, 0.7f);
  }
}

// A slope over clusters of some fifty triangles each must look like one, not like steps: no two vertices next
// to each other differ by much more than the slope has them.
TEST(Smoothing, ASlopeOverClustersHasNoSteps) {
  const Scene scene = wall_scene(test::even_cuts(80), 0.2f);
  const ElementMesh mesh = divide_surfaces(scene, 250);
  ASSERT_GT(mesh.cluster_count(), 200u);
  std::vector<Irradiance> irradiance;
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    double x = 0.0;
    for (std::size_t k = 0; k < mesh.patch_count(i); ++k) x += mesh.patch(i, k).centroid().position.x;
    irradiance.push_back(of(float(x / double(mesh.patch_count(i))), 0.0f));
  }
  const VertexMesh vertices(mesh);
  const std::vector<Irradiance> value = vertex_irradiance(vertices, mesh, irradiance);
  double steepest = 0.0;
  for (const auto& corner : vertices.faces().corner)
    for (int k = 0; k < 3; ++k) {
      const V3f along = vertices.position(corner[k]) - vertices.position(corner[(k + 1) % 3]);
      const double step = value[corner[k]].direct.x - value[corner[(k + 1) % 3]].direct.x;
      steepest = std::max(steepest, std::abs(step) / double(along.length()));
    }
  // One triangle around each vertex would make it 5 or more.
  EXPECT_LT(steepest, 2.0);
}

}  // namespace
}  // namespace twopass
