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
    EXPECT_NEAR(flat / (2.0 * triangle), 1.0, 1e-7);
    EXPECT_NEAR(round / (2.0 * 4.0 * pi * 2.25), 1.0, 1e-7);
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
      EXPECT_EQ(&mesh.root(root.first_element + k), &root);
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
  std::vector<float> fraction(mesh.count(), 1.0f);
  fraction[0] = 0.25f;
  mesh.expose(fraction);
  EXPECT_DOUBLE_EQ(mesh.area(0), 0.25 * area);
  EXPECT_DOUBLE_EQ(mesh.area(1), other);
  EXPECT_FLOAT_EQ(static_cast<float>(mesh.patch(0).area), static_cast<float>(area));
  EXPECT_FLOAT_EQ(static_cast<float>(mesh.whole_area(0)), static_cast<float>(area));
}

TEST(Elements, AChildIsAQuarterOfItsCell) {
  for (const bool inverted : {false, true}) {
    const ElementCell cell{3, 5, inverted, 16};
    const std::array<V2i, 3> corner = cell_corners(cell);
    for (int k = 0; k < 4; ++k) {
      const ElementCell child = child_cell(cell, k);
      EXPECT_EQ(child.divisions, 32u);
      const std::array<V2i, 3> small = cell_corners(child);
      for (int j = 0; j < 3; ++j) {
        // Twice the corner k moves half way towards it; in the middle one, corner j lies opposite.
        const V2i expected = k < 3 ? corner[k] + corner[j] : corner[(j + 1) % 3] + corner[(j + 2) % 3];
        EXPECT_EQ(small[j], expected) << inverted << " " << k << " " << j;
      }
    }
  }
}

// Splits a random third of the elements, a few times over.
ElementMesh split_at_random(ElementMesh mesh, int times) {
  for (int t = 0; t < times; ++t) {
    std::vector<bool> chosen(mesh.count());
    for (std::uint32_t i = 0; i < mesh.count(); ++i)
      chosen[i] = Sampler(7, i, static_cast<std::uint32_t>(t)).next_1d() < 0.3f;
    mesh = mesh.split(chosen);
  }
  return mesh;
}

TEST(Elements, SplitMeshesFindTheirElementsAndKeepTheArea) {
  const Scene scene = two_sided_scene();
  const ElementMesh coarse = divide_surfaces(scene, 100);
  const ElementMesh mesh = split_at_random(coarse, 4);
  ASSERT_GT(mesh.count(), 4 * coarse.count());
  double area = 0.0, coarse_area = 0.0;
  for (std::uint32_t i = 0; i < coarse.count(); ++i) coarse_area += coarse.area(i);
  for (std::uint32_t i = 0; i < mesh.count(); ++i) {
    area += mesh.area(i);
    const Patch patch = mesh.patch(i);
    EXPECT_EQ(mesh.find(look_at_point(scene, patch.centroid())), i);
    ElementPoint point = patch.sample(Sampler(1, i, 0).next_2d());
    point.position += (patch.centroid().position - point.position) * 1e-2;
    const ElementMesh::Location location = mesh.locate(look_at_point(scene, point));
    ASSERT_EQ(location.element, i);
    // The place in the element is the place in space.
    if (mesh.is_analytic(mesh.root(i).shape)) continue;
    std::array<V3d, 3> corner;
    const std::array<V2i, 3> numerators = cell_corners(mesh.cell(i));
    for (int k = 0; k < 3; ++k)
      corner[k] = mesh.grid_point(mesh.root(i), numerators[k], mesh.cell(i).divisions);
    const V3d back_again = corner[0] + (corner[1] - corner[0]) * static_cast<double>(location.u) +
                           (corner[2] - corner[0]) * static_cast<double>(location.v);
    EXPECT_LT((back_again - point.position).length(), 1e-5);
  }
  EXPECT_NEAR(area / coarse_area, 1.0, 1e-6);
}

TEST(Elements, SplittingEverythingIsAGridAgain) {
  const Scene scene = two_sided_scene();
  const ElementMesh coarse = divide_surfaces(scene, 100);
  const ElementMesh fine = coarse.split(std::vector<bool>(coarse.count(), true));
  EXPECT_EQ(fine.count(), 4 * coarse.count());
  for (std::uint32_t i = 0; i < fine.count(); ++i)
    EXPECT_EQ(fine.find(look_at_point(scene, fine.patch(i).centroid())), i);
}

TEST(Elements, WhatIsTooFineToTellApartIsNotSplit) {
  const Scene scene = two_sided_scene();
  ElementMesh mesh = divide_surfaces(scene, 0);
  const std::size_t start = mesh.count();
  for (int k = 0; k < 20; ++k) {
    std::vector<bool> chosen(mesh.count(), false);
    chosen[0] = true;
    mesh = mesh.split(chosen);
  }
  EXPECT_EQ(mesh.count(), start + 13 * 3);  // 2^13 divisions of an edge are the most
  EXPECT_EQ(mesh.find(look_at_point(scene, mesh.patch(0).centroid())), 0u);
}

}  // namespace
}  // namespace twopass
