#include "render/load/load_obj_scene.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

using LoadObjScene = LoadTest;

constexpr std::string_view square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

std::vector<std::string> names(const LoadedScene& loaded) {
  std::vector<std::string> result;
  for (const Shape& shape : loaded.scene.shapes) result.push_back(shape.name);
  return result;
}

TEST_F(LoadObjScene, AShapeForEachGroupAndMaterial) {
  write("scene.mtl", "newmtl white\nKd 0.7 0.7 0.7\nnewmtl lamp\nKe 1 2 3\n");
  const LoadedScene loaded = load_obj("mtllib scene.mtl\n" + std::string(square) +
                                      "g floor\nusemtl white\nf 1 2 3\nusemtl lamp\nf 1 3 4\ng wall\nf 1 2 4\n"
                                      "g floor\nusemtl white\nf 2 3 4\n");
  EXPECT_EQ(names(loaded), (std::vector<std::string>{"floor:white", "floor:lamp", "wall"}));
  EXPECT_EQ(mesh_of(loaded, 0).triangles.size(), 2u);
  EXPECT_EQ(loaded.scene.materials.size(), 2u);
  EXPECT_EQ(loaded.scene.shapes[1].radiance[front], C3f(1, 2, 3));
  EXPECT_EQ(loaded.scene.shapes[1].radiance[back], C3f(0.0f));
  EXPECT_EQ(loaded.scene.shapes[2].radiance[front], C3f(1, 2, 3));
  EXPECT_FALSE(is_emitter(loaded.scene.shapes[0]));
  EXPECT_FALSE(loaded.scene.camera);
  EXPECT_TRUE(loaded.notes.empty());
}

TEST_F(LoadObjScene, ShapesWithoutGroupsAreNamedAfterMaterialOrFile) {
  const LoadedScene loaded = load_obj(std::string(square) + "f 1 2 3\nusemtl red\nf 1 3 4\n");
  EXPECT_EQ(names(loaded), (std::vector<std::string>{"scene", "red"}));
}

TEST_F(LoadObjScene, MissingMaterialsAreGreyWithNotes) {
  const LoadedScene loaded =
      load_obj("mtllib none.mtl\n" + std::string(square) + "f 1 2 3\nusemtl red\nf 1 3 4\n");
  EXPECT_TRUE(has_note(loaded, "its material library 'none.mtl' does not exist"));
  EXPECT_TRUE(has_note(loaded, "scene.obj: material 'red' is not defined: grey (0.5)"));
  EXPECT_TRUE(has_note(loaded, "faces without usemtl are grey"));
  for (const Material& material : loaded.scene.materials)
    expect_near(std::get<Diffuse>(material.side[front].uniform()).reflectance, V3f(0.5f));
}

TEST_F(LoadObjScene, LibrariesWithSpacesSeveralAndBackslashes) {
  write("my lib.mtl", "newmtl a\nKd 1 0 0\n");
  write("sub/b.mtl", "newmtl b\nKd 0 1 0\n");
  write("c.mtl", "newmtl c\nKd 0 0 1\n");
  const LoadedScene loaded = load_obj("mtllib my lib.mtl\nmtllib sub\\b.mtl c.mtl\n" + std::string(square) +
                                      "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\nusemtl c\nf 1 2 3\n");
  EXPECT_TRUE(loaded.notes.empty()) << loaded.notes[0];
  expect_near(std::get<Diffuse>(loaded.scene.materials[2].side[front].uniform()).reflectance, {0, 0, 1});
}

TEST_F(LoadObjScene, LooksBesideTheFileForWhatIsMissing) {
  write("other.mtl", "newmtl a\nKd 1 0 0\n");
  write("scene.mtl", "newmtl a\nKd 0 0 0\nnewmtl lamp\nKe 1 1 1\n");
  const LoadedScene loaded =
      load_obj("mtllib other.mtl\n" + std::string(square) + "usemtl a\nf 1 2 3\nusemtl lamp\nf 1 3 4\n");
  EXPECT_TRUE(has_note(loaded, "are taken from"));
  EXPECT_TRUE(is_emitter(loaded.scene.shapes[1]));
  expect_near(std::get<Diffuse>(loaded.scene.materials[0].side[front].uniform()).reflectance, {1, 0, 0});
}

TEST_F(LoadObjScene, DropsTrianglesWithoutAreaWithANote) {
  const LoadedScene loaded = load_obj(std::string(square) + "f 1 2 3\nf 1 1 1\nf 1 2 2\ng empty\nf 3 3 4\n");
  EXPECT_EQ(loaded.scene.shapes.size(), 1u);
  EXPECT_TRUE(has_note(loaded, "3 triangles without area are left out"));
  expect_error([&] { load_obj(std::string(square) + "f 1 1 1\n"); }, {"none of its triangles has an area"});
}

TEST_F(LoadObjScene, NormalsDecideWhereTheFrontIs) {
  const LoadedScene loaded = load_obj(std::string(square) + "vn 0 0 -1\nf 1//1 2//1 3//1\n");
  expect_near(normal_of(mesh_of(loaded), 0), {0, 0, -1});
  EXPECT_TRUE(mesh_of(loaded).normals.empty());  // flat
  EXPECT_TRUE(has_note(loaded, "1 triangles faced away from their own normals"));
}

TEST_F(LoadObjScene, SmoothingGroupsReachAcrossShapes) {
  // Folded along x = 1 by 90 degrees: two groups, one smooth surface.
  const LoadedScene loaded =
      load_obj(std::string(square) + "v 1 0 -1\nv 1 1 -1\ns 1\ng a\nf 1 2 3 4\ng b\nf 2 5 6 3\n");
  for (std::size_t shape = 0; shape < 2; ++shape) {
    const Mesh& mesh = mesh_of(loaded, shape);
    ASSERT_EQ(mesh.normals.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i)
      if (mesh.positions[i].x == 1.0f && mesh.positions[i].z == 0.0f)
        expect_near(mesh.normals[i], V3f(1, 0, 1).normalized());
  }
  EXPECT_TRUE(mesh_of(load_obj(std::string(square) + "s off\nf 1 2 3\n")).normals.empty());
}

TEST_F(LoadObjScene, ErrorsOfLibrariesNameThem) {
  write("bad.mtl", "newmtl a\nKd x\n");
  expect_error([&] { load_obj("mtllib bad.mtl\n" + std::string(square) + "usemtl a\nf 1 2 3\n"); },
               {"bad.mtl:2:"});
}

}  // namespace
}  // namespace twopass
