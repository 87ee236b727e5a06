#include "render/load/obj_mesh.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

ObjFile mesh_of_text(const std::string& text) {
  Notes notes;
  return parse_obj(text, "a.obj", notes);
}
Mesh smooth_mesh(const std::string& text) {
  ObjFile file = mesh_of_text(text);
  add_smooth_normals(file);
  return mesh_of(file);
}

const std::string square_corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
/// The cube [-1, 1]^3 without faces, and its six faces, outwards.
const std::string cube = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n";
const std::string cube_faces = "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

TEST(ObjMesh, SharesVerticesByAllTheirIndices) {
  const Mesh mesh = mesh_of(
      mesh_of_text(square_corners + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0.5 0.5\nf 1/1 2/2 3/3\nf 1/1 3/4 4/2\n"));
  EXPECT_EQ(mesh.positions.size(), 5u);  // position 3 has two texture coordinates
  ASSERT_EQ(mesh.uvs.size(), 5u);
  EXPECT_EQ(mesh.uvs[1], V2f(1, 0));
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_TRUE(mesh_of(mesh_of_text(square_corners + "f 1 2 3\n")).uvs.empty());
}

TEST(ObjMesh, CornersWithoutNormalsGetTheirFaces) {
  const Mesh mesh =
      mesh_of(mesh_of_text(square_corners + "vn 0 0.6 0.8\nvn 0 0 0\nf 1//1 2//1 3\nf 1 3 4//2\n"));
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  EXPECT_EQ(mesh.positions.size(), 6u);  // every face has its own
  expect_near(mesh.normals[0], {0, 0.6f, 0.8f});
  for (std::size_t i = 2; i < 6; ++i) expect_near(mesh.normals[i], {0, 0, 1});
}

TEST(ObjMesh, TriangulatesConcaveFaces) {
  const Mesh mesh = mesh_of(mesh_of_text("v 0 0 0\nv 2 1 0\nv 0 2 0\nv 0.5 1 0\nf 1 2 3 4\n"));
  EXPECT_NEAR(area_of(mesh), 1.5, 1e-6);
  for (std::size_t i = 0; i < 2; ++i) expect_near(normal_of(mesh, i), {0, 0, 1});
}

TEST(ObjMesh, VerticesOfAGridAreShared) {
  // More vertices than any hash table gets by without collisions.
  constexpr int n = 60;
  std::string text;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) text += "v " + std::to_string(x) + " " + std::to_string(y) + " 0\n";
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int a = y * (n + 1) + x + 1;
      for (const int corner : {a, a + 1, a + n + 2, a + n + 1})
        text += (corner == a ? "f " : " ") + std::to_string(corner);
      text += '\n';
    }
  const Mesh mesh = mesh_of(mesh_of_text(text));
  EXPECT_EQ(mesh.positions.size(), std::size_t{(n + 1) * (n + 1)});
  EXPECT_NEAR(area_of(mesh), n * n, 1e-3);
}

TEST(ObjMesh, ASmoothingGroupIsSmooth) {
  const Mesh mesh = smooth_mesh(cube + "s 1\n" + cube_faces);
  ASSERT_EQ(mesh.positions.size(), 8u);
  for (std::size_t i = 0; i < 8; ++i) expect_near(mesh.normals[i], mesh.positions[i].normalized());
}

TEST(ObjMesh, WithoutSmoothingGroupsThereAreEdges) {
  EXPECT_TRUE(smooth_mesh(cube + cube_faces).normals.empty());
  EXPECT_TRUE(smooth_mesh(cube + "s 1\ns off\n" + cube_faces).normals.empty());
}

TEST(ObjMesh, BetweenSmoothingGroupsThereIsAnEdge) {
  // Two squares folded along the x axis, by 90 degrees.
  const std::string v = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 1\nv 0 0 1\n";
  const Mesh two = smooth_mesh(v + "s 1\nf 1 2 3 4\ns 2\nf 2 1 6 5\n");
  ASSERT_EQ(two.normals.size(), 8u);
  for (std::size_t i = 0; i < 4; ++i) expect_near(two.normals[i], {0, 0, 1});
  for (std::size_t i = 4; i < 8; ++i) expect_near(two.normals[i], {0, 1, 0});
  const Mesh one = smooth_mesh(v + "s 1\nf 1 2 3 4\nf 2 1 6 5\n");
  ASSERT_EQ(one.normals.size(), 6u);
  expect_near(one.normals[0], V3f(0, 1, 1).normalized());
  expect_near(one.normals[2], {0, 0, 1});
}

TEST(ObjMesh, TheFilesOwnNormalsWin) {
  const Mesh mesh = smooth_mesh(cube + "vn 1 0 0\ns 1\nf 4//1 3//1 2//1 1//1\n" + cube_faces.substr(10));
  expect_near(mesh.normals[0], {1, 0, 0});
}

TEST(ObjMesh, SmoothingNeverTurnsAwayFromTheFace) {
  // A fold so sharp that the mean of two large faces looks away from the third one.
  const Mesh mesh = smooth_mesh(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.1\nv 0.5 0 -0.1\ns 1\nf 1 2 3\nf 2 4 3\nf 1 5 2\nf 2 1 3\n");
  for (const V3u& t : mesh.triangles) {
    const V3f n = (mesh.positions[t.y] - mesh.positions[t.x]).cross(mesh.positions[t.z] - mesh.positions[t.x]);
    for (const std::uint32_t corner : {t.x, t.y, t.z}) EXPECT_GT(mesh.normals[corner].dot(n), 0.0f);
  }
}

}  // namespace
}  // namespace twopass
