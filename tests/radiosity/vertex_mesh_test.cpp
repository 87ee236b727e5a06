#include "radiosity/vertex_mesh.h"

#include <map>

#include <gtest/gtest.h>

#include "radiosity/smoothing.h"
#include "radiosity/subdivision.h"
#include "tests/radiosity/test_scenes.h"
#include "tests/radiosity/walls.h"

namespace twopass {
namespace {

Scene square() {
  SceneDescription scene;
  test::add_diffuse(scene, "square", test::quad(V3f(0.0f), V3f(1, 0, 0), V3f(0, 1, 0)), C3f(0.5f));
  return Scene(std::move(scene));
}

TEST(VertexMesh, GridsShareTheVerticesOfTheirCommonEdge) {
  const Scene scene = square();
  const std::uint16_t divisions[] = {6};
  const ElementMesh mesh = test::mesh_of_divisions(scene, divisions);
  const VertexMesh vertices(mesh);
  EXPECT_EQ(vertices.count(), 49u);  // of a 6 x 6 grid of squares
  EXPECT_TRUE(vertices.hanging().empty());
  EXPECT_EQ(vertices.faces().corner.size(), 72u);
  for (std::uint32_t face = 0; face < 72; ++face) {
    const Patch patch = mesh.patch(face);
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(vertices.position(vertices.faces().corner[face][k]), V3f(patch.corner[k]));
    EXPECT_TRUE(vertices.edge_vertices(face).empty());
  }
}

TEST(VertexMesh, OneDivisionBesideThreeHangsAtTheThirds) {
  const Scene scene = square();
  const std::uint16_t divisions[] = {1, 3};
  const ElementMesh mesh = test::mesh_of_divisions(scene, divisions);
  const VertexMesh vertices(mesh);
  EXPECT_EQ(vertices.count(), 4u + 2 + 4 + 1);  // corners, the diagonal, two edges, the middle
  ASSERT_EQ(vertices.hanging().size(), 2u);
  for (const VertexMesh::Hanging& h : vertices.hanging()) {
    const V3f expected =
        vertices.position(h.from) + (vertices.position(h.to) - vertices.position(h.from)) * h.t;
    EXPECT_LT((vertices.position(h.vertex) - expected).length(), 1e-6f);
    EXPECT_TRUE(std::abs(h.t - 1.0f / 3.0f) < 1e-6f || std::abs(h.t - 2.0f / 3.0f) < 1e-6f);
  }
  ASSERT_EQ(vertices.edge_vertices(0).size(), 2u);
  EXPECT_EQ(vertices.edge_vertices(0)[0].edge, 2u);  // the diagonal runs from the third corner to the first
}

// Neither has a corner where the other has one: only the ends are free.
TEST(VertexMesh, GridsThatDoNotNestAreLinearBetweenWhatTheyShare) {
  const Scene scene = square();
  const std::uint16_t divisions[] = {4, 6};
  const ElementMesh mesh = test::mesh_of_divisions(scene, divisions);
  const VertexMesh vertices(mesh);
  std::size_t on_diagonal = 0;
  for (const VertexMesh::Hanging& h : vertices.hanging()) {
    const V3f p = vertices.position(h.vertex), from = vertices.position(h.from), to = vertices.position(h.to);
    EXPECT_EQ(p.x, p.y);
    EXPECT_TRUE(from.x == 0.0f || from.x == 0.5f);
    EXPECT_EQ(std::abs(to.x - from.x), 0.5f);
    ++on_diagonal;
  }
  EXPECT_EQ(on_diagonal, 6u);  // 1/6 1/4 1/3 2/3 3/4 5/6; a half is common
}

TEST(VertexMesh, EveryHangingVertexLiesBetweenItsEndsAndComesAfterThem) {
  const Scene scene = square();
  const std::uint16_t divisions[] = {1, 3};
  const ElementMesh mesh = test::split_at_random(test::mesh_of_divisions(scene, divisions), 5, 0.4f);
  const VertexMesh vertices(mesh);
  ASSERT_GT(vertices.hanging().size(), 100u);
  std::vector<bool> hangs(vertices.count(), false), settled(vertices.count(), false);
  for (const VertexMesh::Hanging& h : vertices.hanging()) {
    EXPECT_FALSE(hangs[h.vertex]);
    hangs[h.vertex] = true;
  }
  for (const VertexMesh::Hanging& h : vertices.hanging()) {
    EXPECT_TRUE((!hangs[h.from] || settled[h.from]) && (!hangs[h.to] || settled[h.to]));
    settled[h.vertex] = true;
    const V3f expected =
        vertices.position(h.from) + (vertices.position(h.to) - vertices.position(h.from)) * h.t;
    EXPECT_LT((vertices.position(h.vertex) - expected).length(), 1e-6f);
  }
}

// Floor and wall of a room have vertices of their own where they meet, but know of each other's.
TEST(VertexMesh, CreasesAreNotShared) {
  const Scene scene(test::lit_cube(0.5f));
  const std::uint16_t divisions[] = {2, 2, 4, 4};
  const ElementMesh mesh = test::mesh_of_divisions(scene, divisions);
  const VertexMesh vertices(mesh);
  std::map<std::tuple<float, float, float>, int> surfaces;
  for (std::uint32_t v = 0; v < vertices.count(); ++v) {
    const V3f& p = vertices.position(v);
    ++surfaces[{p.x, p.y, p.z}];
  }
  EXPECT_EQ((surfaces[{0.0f, 0.0f, 0.0f}]), 3);
  EXPECT_EQ((surfaces[{1.0f, 0.25f, 0.0f}]), 2);  // the floor is cut in two there, the wall in four
  EXPECT_EQ((surfaces[{0.5f, 0.5f, 0.0f}]), 1);
}

TEST(VertexMesh, BothSidesOfASheetAreTwoSurfaces) {
  SceneDescription description;
  const Bsdf white = Diffuse{C3f(0.8f)};
  description.materials = {two_sided("both", white, white)};
  description.shapes = {{"sheet", test::quad(V3f(0.0f), V3f(1, 0, 0), V3f(0, 1, 0)), 0, {}}};
  const Scene scene(std::move(description));
  EXPECT_EQ(VertexMesh(divide_surfaces(scene, 0)).count(), 8u);
}

TEST(VertexMesh, TheOctantsOfASphereAreOneSurface) {
  SceneDescription description;
  test::add_diffuse(description, "ball", Sphere{V3f(1, 2, 3), 2.0f, false}, C3f(0.5f));
  const Scene scene(std::move(description));
  EXPECT_EQ(VertexMesh(divide_surfaces(scene, 8)).count(), 6u);
  // An octahedron with n^2 faces on each of its 8 has 4 n^2 + 2 vertices.
  const ElementMesh fine = divide_surfaces(scene, 8 * 36);
  const std::uint32_t n = fine.roots()[0].divisions;
  EXPECT_EQ(VertexMesh(fine).count(), 4 * n * n + 2);
}

// Ten thousand triangles around one point, and a hundred thousand clusters' triangles: a second would be a sign
// of work that grows with the square.
// With quadratic work this would hang.
TEST(VertexMesh, SurvivesFansAndFineWalls) {
  SceneDescription description;
  Mesh fan;
  fan.positions.push_back(V3f(0.0f));
  const std::uint32_t n = 20000;
  for (std::uint32_t k = 0; k <= n; ++k) {
    const double a = 2.0 * pi * (k % n) / n;
    fan.positions.push_back(V3f(V3d(std::cos(a), std::sin(a), k % 2 == 0 ? 0.0 : 0.1)));
    if (k > 0) fan.triangles.emplace_back(0, k, k + 1);
  }
  test::add_diffuse(description, "fan", fan, C3f(0.5f));
  test::add_diffuse(description, "wall", test::wall(test::even_cuts(150), 0.3f), C3f(0.5f));
  const Scene scene(std::move(description));
  const ElementMesh mesh = divide_surfaces(scene, 1000);
  ASSERT_GT(mesh.cluster_count(), 10u);
  const SmoothIrradiance smooth(mesh, std::vector<Irradiance>(mesh.count(), {C3f(1.0f), C3f(2.0f)}));
  EXPECT_EQ(smooth.at({0, mesh.root_index(0), 0.25f, 0.25f}).total(), C3f(3.0f));
}

}  // namespace
}  // namespace twopass
