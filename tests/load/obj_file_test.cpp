#include "render/load/obj_file.h"

#include <numeric>

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class ObjFileTest : public LoadTest {
 protected:
  ObjFile read(std::string_view text) const {
    Notes notes;
    return read_obj(write("a.obj", text), notes);
  }
  static Mesh whole_mesh(const ObjFile& file) {
    std::vector<std::uint32_t> all(file.faces.size());
    std::iota(all.begin(), all.end(), 0u);
    return mesh_of_faces(file, all);
  }
};

constexpr std::string_view square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(ObjFileTest, ReadsPositionsAndFaces) {
  const ObjFile file = read(std::string(square) + "f 1 2 3 4\n");
  EXPECT_EQ(file.positions.size(), 4u);
  ASSERT_EQ(file.faces.size(), 1u);
  EXPECT_EQ(file.faces[0].corner_count, 4u);
  EXPECT_EQ(file.faces[0].line, 5u);
  EXPECT_EQ(file.corners[1].position, 1u);
  EXPECT_EQ(file.corners[1].uv, no_obj_index);
  const Mesh mesh = whole_mesh(file);
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_TRUE(mesh.uvs.empty());
}

TEST_F(ObjFileTest, NegativeIndicesCountBackwards) {
  const ObjFile file = read(std::string(square) + "f -4 -3 -2\nv 5 5 5\nf -1 -5 -4\n");
  EXPECT_EQ(file.corners[0].position, 0u);
  EXPECT_EQ(file.corners[3].position, 4u);
  EXPECT_EQ(file.corners[4].position, 0u);
}

TEST_F(ObjFileTest, IndicesMayPointForward) {
  EXPECT_EQ(read("f 1 2 3\n" + std::string(square)).corners[2].position, 2u);
}

TEST_F(ObjFileTest, SharesVerticesByAllTheirIndices) {
  const std::string text =
      std::string(square) + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0.5 0.5\nf 1/1 2/2 3/3\nf 1/1 3/4 4/2\n";
  const Mesh mesh = whole_mesh(read(text));
  EXPECT_EQ(mesh.positions.size(), 5u);  // position 3 has two texture coordinates
  ASSERT_EQ(mesh.uvs.size(), 5u);
  EXPECT_EQ(mesh.uvs[1], V2f(1, 0));
}

TEST_F(ObjFileTest, CornersWithoutNormalsGetTheirFaces) {
  const Mesh mesh =
      whole_mesh(read(std::string(square) + "vn 0 0.6 0.8\nvn 0 0 0\nf 1//1 2//1 3\nf 1 3 4//2\n"));
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  EXPECT_EQ(mesh.positions.size(), 6u);  // every face has its own
  expect_near(mesh.normals[0], {0, 0.6f, 0.8f});
  for (std::size_t i = 2; i < 6; ++i) expect_near(mesh.normals[i], {0, 0, 1});
}

TEST_F(ObjFileTest, TriangulatesConcaveFaces) {
  const Mesh mesh = whole_mesh(read("v 0 0 0\nv 2 1 0\nv 0 2 0\nv 0.5 1 0\nf 1 2 3 4\n"));
  EXPECT_NEAR(area_of(mesh), 1.5, 1e-6);
  for (std::size_t i = 0; i < 2; ++i) expect_near(normal_of(mesh, i), {0, 0, 1});
}

TEST_F(ObjFileTest, RemembersGroupsAndMaterials) {
  const ObjFile file =
      read(std::string(square) +
           "f 1 2 3\no box\nf 1 2 3\ng side a\nusemtl my mat\nf 1 2 3\no lid\nf 1 2 3\nusemtl other\n"
           "g\nf 1 2 3\n");
  EXPECT_EQ(file.groups, (std::vector<std::string>{"", "box", "box/side a", "lid"}));
  EXPECT_EQ(file.materials, (std::vector<std::string>{"", "my mat", "other"}));
  EXPECT_EQ(file.faces[0].group, 0u);
  EXPECT_EQ(file.faces[2].group, 2u);
  EXPECT_EQ(file.faces[2].material, 1u);
  EXPECT_EQ(file.faces[3].group, 3u);
  EXPECT_EQ(file.faces[4].material, 2u);
}

TEST_F(ObjFileTest, RefusesIndicesThatLeadNowhere) {
  const std::string v(square);
  expect_error([&] { read(v + "f 1 2 5\n"); }, {"a.obj:5: position 5 does not exist: there are 4"});
  expect_error([&] { read(v + "f 1 2 -5\n"); }, {"a.obj:5: index -5 points before the first of 4"});
  expect_error([&] { read(v + "f 1/1 2/1 3/1\n"); }, {"a.obj:5: texture coordinate 1 does not exist"});
  expect_error([&] { read(v + "f 1//1 2//1 3//1\n"); }, {"a.obj:5: normal 1 does not exist"});
}

TEST_F(ObjFileTest, RefusesHugeCoordinates) {
  expect_error([&] { read("v 0 0 0\nv 1e20 0 0\n"); }, {"a.obj:2: a coordinate is larger than 1e12"});
  expect_error([&] { read("vn 1e39 0 0\n"); }, {"a.obj:1: a normal is too large"});
}

TEST_F(ObjFileTest, RefusesFilesWithoutFaces) {
  expect_error([&] { read(square); }, {"a.obj: there is no face in this file"});
  expect_error([&] { read(""); }, {"there is no face"});
  expect_error([&] { read("<html><body>not found</body></html>"); }, {"there is no face"});
}

}  // namespace
}  // namespace twopass
