#include "radiosity/elements.h"

#include <gtest/gtest.h>

#include "radiosity/subdivision.h"
#include "render/core/sampler.h"
#include "tests/support/scenes.h"

namespace twopass {
namespace {

// A skew triangle seen from both sides, and a sphere seen from both sides.
Scene two_sided_scene() {
  SceneDescription scene;
  const Bsdf white = Diffuse{C3f(0.8f)}, dim = Diffuse{C3f(0.2f)};
  scene.materials = {two_sided("both", white, dim)};
  Mesh mesh;
  mesh.positions = {V3f(0, 0, 0), V3f(3, 0.5f, 0.25f), V3f(-0.5f, 2, 1)};
  mesh.triangles = {{0, 1, 2}};
  scene.shapes = {{"triangle", mesh, 0, {C3f(0.0f), C3f(0.0f)}},
                  {"ball", Sphere{V3f(10, 0, 0), 1.5f, true}, 0, {C3f(0.0f), C3f(0.0f)}}};
  return Scene(std::move(scene));
}

// The point of the surface that is seen by looking at `target` from the side that it shows.
SurfacePoint look_at_point(const Scene& scene, const ElementPoint& target) {
  const V3d eye = target.position + target.normal * 0.01;
  const Ray ray{V3f(eye), V3f(-target.normal)};
  return scene.surface_point(ray, scene.caster().intersect(ray));
}

TEST(Elements, FindsEveryElementFromItsPoints) {
  const Scene scene = two_sided_scene();
  const ElementMesh mesh = divide_surfaces(scene, 1000);
  ASSERT_GT(mesh.count(), 500u);
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    const Patch patch = mesh.patch(i);
    EXPECT_EQ(mesh.find(look_at_point(scene, patch.centroid())), i);
    for (std::uint32_t k = 0; k < 8; ++k) {
      // A little towards the middle: the border belongs to either side.
      ElementPoint point = patch.sample(Sampler(1, i, k).next_2d());
      point.position += (patch.centroid().position - point.position) * 1e-3;
      EXPECT_EQ(mesh.find(look_at_point(scene, point)), i);
    }
  }
}

TEST(Elements, AreasAddUpToTheSurface) {
  const Scene scene = two_sided_scene();
  const double triangle = triangle_patch(std::get<Mesh>(scene.shapes()[0].geometry), 0, front).area;
  for (const std::size_t most : {0, 100, 5000}) {
    const ElementMesh mesh = divide_surfaces(scene, most);
    double flat = 0.0, round = 0.0;
    for (std::uint32_t i = 0; i < mesh.count(); ++i) (mesh.root(i).shape == 0 ? flat : round) += mesh.area(i);
    EXPECT_NEAR(flat, 2.0 * triangle, 1e-10);
    EXPECT_NEAR(round, 2.0 * 4.0 * pi * 2.25, 1e-9);
  }
}

TEST(Elements, PolygonsRunCounterClockwiseAboutTheirSide) {
  const Scene scene = two_sided_scene();
  const ElementMesh mesh = divide_surfaces(scene, 200);
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    const Patch patch = mesh.patch(i);
    const V3d area_vector = polygon_area_vector(patch.polygon());
    EXPECT_GT(area_vector.dot(patch.centroid().normal), 0.0);
    EXPECT_LE(area_vector.length(), patch.area * (1.0 + 1e-12));
    const ElementRoot& root = mesh.root(i);
    EXPECT_FLOAT_EQ(mesh.reflectance(i).x, root.side == front ? 0.8f : 0.2f);
    if (root.shape == 1) {  // its front is the inside
      EXPECT_EQ(patch.signed_radius < 0.0, root.side == front);
    }
  }
}

TEST(Elements, CellsNumberTheirRootWithoutGaps) {
  const Scene scene = two_sided_scene();
  const ElementMesh mesh = divide_surfaces(scene, 3000);
  for (const ElementRoot& root : mesh.roots()) {
    std::uint32_t upright = 0;
    for (std::uint32_t k = 0; k < std::uint32_t{root.divisions} * root.divisions; ++k) {
      const ElementCell cell = mesh.cell(root.first_element + k);
      EXPECT_LT(cell.column + cell.row + (cell.inverted ? 1 : 0), root.divisions);
      if (!cell.inverted) ++upright;
    }
    EXPECT_EQ(upright, root.divisions * (root.divisions + 1u) / 2);
  }
}

TEST(Elements, CornersOfTheTriangleAndPointsBeyondItBelongToIt) {
  const Scene scene = two_sided_scene();
  const ElementMesh mesh = divide_surfaces(scene, 777);
  const ElementRoot& root = mesh.roots()[0];
  SurfacePoint point = look_at_point(scene, mesh.patch(0).centroid());
  for (const V2f& uv : {V2f(0, 0), V2f(1, 0), V2f(0, 1), V2f(0.5f, 0.5f), V2f(1.0000001f, -1e-7f),
                        V2f(-1e-7f, 1.0f), V2f(0.50000006f, 0.50000006f)}) {
    point.u = uv.x, point.v = uv.y;
    EXPECT_GE(mesh.find(point), root.first_element);
    EXPECT_LT(mesh.find(point), root.first_element + std::uint32_t{root.divisions} * root.divisions);
  }
}

TEST(Elements, ExposedPartsShrinkTheArea) {
  const Scene scene = two_sided_scene();
  ElementMesh mesh = divide_surfaces(scene, 0);
  const double area = mesh.area(0), other = mesh.area(1);
  std::vector<double> fraction(mesh.count(), 1.0);
  fraction[0] = 0.25;
  mesh.expose(fraction);
  EXPECT_DOUBLE_EQ(mesh.area(0), 0.25 * area);
  EXPECT_DOUBLE_EQ(mesh.area(1), other);
  EXPECT_DOUBLE_EQ(mesh.patch(0).area, area);
}

}  // namespace
}  // namespace twopass
