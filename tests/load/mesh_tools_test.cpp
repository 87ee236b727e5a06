#include "render/load/mesh_tools.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

Mesh lone_triangle(const V3f& a, const V3f& b, const V3f& c) {
  Mesh mesh;
  mesh.positions = {a, b, c};
  mesh.triangles.emplace_back(0u, 1u, 2u);
  return mesh;
}

TEST(MeshTools, TransformsPositionsAndNormals) {
  Mesh mesh = lone_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 1});
  mesh.normals.assign(3, normal_of(mesh, 0));
  M44d squash;
  squash.setScale(V3d(2.0, 3.0, 0.5));
  transform(mesh, squash, "here");
  expect_near(mesh.positions[2], {0, 3, 0.5f});
  expect_near(mesh.normals[0], normal_of(mesh, 0));
}

TEST(MeshTools, AttributesStayWithTheirVerticesAndTriangles) {
  Mesh mesh;
  mesh.positions = {V3f(9, 9, 9), V3f(0, 0, 0), V3f(1, 0, 0), V3f(0, 1, 0), V3f(2, 0, 0)};
  mesh.triangles = {V3u(1, 2, 4), V3u(1, 2, 3)};  // the first has no area
  mesh.attributes = {{"vertex_k", {C3f(0.0f), C3f(1.0f), C3f(2.0f), C3f(3.0f), C3f(4.0f)}},
                     {"face_k", {C3f(5.0f), C3f(6.0f)}}};
  EXPECT_EQ(drop_degenerate_triangles(mesh), 1u);
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.attributes[0].values, (std::vector<C3f>{C3f(1.0f), C3f(2.0f), C3f(3.0f)}));
  EXPECT_EQ(mesh.attributes[1].values, std::vector<C3f>{C3f(6.0f)});
  EXPECT_EQ(drop_degenerate_triangles(mesh), 0u);
  EXPECT_EQ(mesh.attributes[1].values.size(), 1u);
}

TEST(MeshTools, NormalsFollowTheFrontThroughAMirror) {
  Mesh mesh = lone_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  mesh.normals.assign(3, V3f(0, 0, 1));
  M44d mirror;
  mirror.setScale(V3d(-1.0, 1.0, 1.0));
  EXPECT_TRUE(is_mirroring(mirror));
  transform(mesh, mirror, "here");
  expect_near(mesh.normals[0], {0, 0, 1});
  expect_near(normal_of(mesh, 0), {0, 0, -1});
  reverse_winding(mesh);
  expect_near(normal_of(mesh, 0), {0, 0, 1});
}

TEST(MeshTools, NormalsSurviveFlattening) {
  Mesh mesh = lone_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  mesh.normals.assign(3, V3f(0, 0, 1));
  M44d flatten;
  flatten.setScale(V3d(1.0, 1.0, 0.0));
  transform(mesh, flatten, "here");
  expect_near(mesh.normals[0], {0, 0, 1});
}

TEST(MeshTools, RefusesCoordinatesOutOfRange) {
  Mesh mesh = lone_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  M44d blow;
  blow.setScale(V3d(1e13));
  expect_error([&] { transform(mesh, blow, "here"); }, {"here: a transformed coordinate is not finite"});
}

TEST(MeshTools, DropsTrianglesWithoutAreaAndWhatOnlyTheyUsed) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1e6f, 0, 0}};
  mesh.uvs.assign(5, V2f(0.5f));
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 1, 3}, {0, 1, 4}};
  EXPECT_EQ(drop_degenerate_triangles(mesh), 3u);
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.positions.size(), 3u);
  EXPECT_EQ(mesh.uvs.size(), 3u);
  expect_near(normal_of(mesh, 0), {0, 0, 1});
  EXPECT_EQ(drop_degenerate_triangles(mesh), 0u);
}

TEST(MeshTools, KeepsSlivers) {
  Mesh mesh = lone_triangle({0, 0, 0}, {1, 0, 0}, {0.5f, 1e-6f, 0});
  EXPECT_EQ(drop_degenerate_triangles(mesh), 0u);
}

TEST(MeshTools, SmoothNormalsWeighByAngle) {
  // A cube's corner made of three squares, one cut into two triangles at the corner: weights must not count it
  // twice.
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
  compute_smooth_normals(mesh);
  expect_near(mesh.normals[0], V3f(1, 1, 1).normalized());
}

TEST(MeshTools, TurnsTrianglesAfterTheirNormals) {
  Mesh mesh = lone_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_EQ(orient_by_normals(mesh), 0u);
  mesh.normals.assign(3, V3f(0, 0, -1));
  EXPECT_EQ(orient_by_normals(mesh), 1u);
  expect_near(normal_of(mesh, 0), {0, 0, -1});
  EXPECT_EQ(orient_by_normals(mesh), 0u);
}

TEST(MeshTools, FlipTurnsEverything) {
  Mesh mesh = lone_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  mesh.normals.assign(3, V3f(0, 0, 1));
  flip(mesh);
  expect_near(mesh.normals[0], {0, 0, -1});
  expect_near(normal_of(mesh, 0), {0, 0, -1});
}

TEST(MeshTools, DropsNormalsThatSayNothing) {
  Mesh flat = lone_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  flat.normals.assign(3, V3f(0, 0, 1));
  Mesh round = flat;
  round.normals[1] = V3f(0.1f, 0, 1).normalized();
  drop_flat_normals(flat);
  drop_flat_normals(round);
  EXPECT_TRUE(flat.normals.empty());
  EXPECT_EQ(round.normals.size(), 3u);
}

}  // namespace
}  // namespace twopass
