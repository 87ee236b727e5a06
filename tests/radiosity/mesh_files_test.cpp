// Read back by Assimp, which knows nothing of us, and by a few lines of our own for what it does not report.
#include "radiosity/mesh_files.h"

#include <cstring>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "radiosity/subdivision.h"
#include "render/image/srgb.h"
#include "render/load/gltf_mesh.h"
#include "render/load/load.h"
#include "tests/image/files.h"
#include "tests/radiosity/test_scenes.h"
#include "tests/radiosity/walls.h"

namespace twopass {
namespace {

class MeshFiles : public FileTest {
 protected:
  MeshFiles() : scene_(test::lit_room()) {
    std::vector<Irradiance> irradiance;
    const ElementMesh mesh = test::split_at_random(divide_surfaces(scene_, 300), 2, 0.3f);
    for (std::uint32_t i = 0; i < mesh.count(); ++i)
      irradiance.push_back({C3f(Sampler(1, i, 0).next_1d(), 0.5f, 0.1f), C3f(0.2f)});
    display_ = display_mesh(scene_, Solution(mesh, irradiance, {}));
  }

  const Scene scene_;
  DisplayMesh display_;
};

TEST_F(MeshFiles, GlbIsReadBackByAnotherProgramsReader) {
  write_glb(file("a.glb"), display_, scene_);
  Assimp::Importer importer;
  const aiScene* read = importer.ReadFile(file("a.glb").string(), aiProcess_ValidateDataStructure);
  ASSERT_TRUE(read) << importer.GetErrorString();
  ASSERT_EQ(read->mNumMeshes, display_.sides.size());
  for (unsigned m = 0; m < read->mNumMeshes; ++m) {
    const aiMesh& mesh = *read->mMeshes[m];
    const DisplaySide& side = display_.sides[m];
    EXPECT_EQ(mesh.mNumVertices, side.position.size());
    ASSERT_EQ(mesh.mNumFaces, side.triangle.size());
    ASSERT_TRUE(mesh.HasVertexColors(0));
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      ASSERT_EQ(mesh.mFaces[f].mNumIndices, 3u);
      for (int k = 0; k < 3; ++k) {
        const unsigned i = mesh.mFaces[f].mIndices[k];
        const std::uint32_t j = side.triangle[f][k];
        ASSERT_EQ(V3f(mesh.mVertices[i].x, mesh.mVertices[i].y, mesh.mVertices[i].z), side.position[j]);
        ASSERT_EQ(C3f(mesh.mColors[0][i].r, mesh.mColors[0][i].g, mesh.mColors[0][i].b), side.color[j]);
      }
    }
  }
  ASSERT_EQ(read->mRootNode->mNumChildren, scene_.shapes().size());
  EXPECT_STREQ(read->mRootNode->mChildren[0]->mName.C_Str(), "floor");
}

TEST_F(MeshFiles, OurOwnLoaderReadsTheGlbBack) {
  write_glb(file("a.glb"), display_, scene_);
  Notes notes;
  const GltfDocument document = read_gltf(file("a.glb"), notes);
  GltfLosses losses;
  std::size_t s = 0;
  for (const tinygltf::Mesh& mesh : document.model.meshes)
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      const auto read = read_gltf_primitive(document, primitive, mesh.name, losses);
      ASSERT_TRUE(read);
      const DisplaySide& side = display_.sides.at(s++);
      ASSERT_EQ(read->mesh.triangles.size(), side.triangle.size());
      ASSERT_EQ(read->colors.size(), read->mesh.positions.size());
      for (std::size_t f = 0; f < side.triangle.size(); ++f)
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t i = read->mesh.triangles[f][k], j = side.triangle[f][k];
          ASSERT_EQ(read->mesh.positions[i], side.position[j]);
          ASSERT_EQ(read->colors[i], side.color[j]);
        }
    }
  EXPECT_EQ(s, display_.sides.size());
  const LoadedScene loaded = load_scene(file("a.glb"), {});
  ASSERT_EQ(loaded.scene.shapes.size(), display_.sides.size());
  EXPECT_TRUE(is_emitter(loaded.scene.shapes[0]));
}

// The picture that a glTF viewer makes has the scene's camera: our loader, which knows both conventions, finds
// it again.
TEST_F(MeshFiles, GlbHoldsTheCamera) {
  SceneDescription description = test::lit_room();
  CameraDescription camera;
  camera.to_world = look_at(V3d(0.1, 0.5, -2.0), V3d(0.3, 0.4, 1.0), V3d(0.1, 1.0, 0.0), "test");
  camera.fov_degrees = 35.0;
  camera.fov_axis = FovAxis::y;
  description.camera = camera;
  write_glb(file("a.glb"), display_, Scene(std::move(description)));
  const LoadedScene loaded = load_scene(file("a.glb"), {});
  ASSERT_TRUE(loaded.scene.camera);
  const Camera before(camera, 64, 64), after(*loaded.scene.camera, 64, 64);
  for (const V2f& pixel : {V2f(0, 0), V2f(64, 10), V2f(32, 32)}) {
    const Ray a = before.ray(pixel).ray, b = after.ray(pixel).ray;
    EXPECT_LT((a.direction - b.direction).length(), 1e-5f);
    EXPECT_LT((a.origin - b.origin).length(), 1e-5f);
  }
}

// What the specification demands of the container and of accessors.
TEST_F(MeshFiles, GlbKeepsTheRulesOfTheFormat) {
  write_glb(file("a.glb"), display_, scene_);
  const std::string glb = content_of(file("a.glb"));
  const auto word = [&](std::size_t at) {
    std::uint32_t value;
    std::memcpy(&value, glb.data() + at, 4);
    return value;
  };
  EXPECT_EQ(glb.substr(0, 4), "glTF");
  EXPECT_EQ(word(4), 2u);
  EXPECT_EQ(word(8), glb.size());
  const std::uint32_t json_size = word(12);
  EXPECT_EQ(json_size % 4, 0u);
  EXPECT_EQ(glb.substr(16, 4), "JSON");
  const auto gltf = nlohmann::json::parse(glb.substr(20, json_size));
  const std::size_t binary = 20 + json_size;
  EXPECT_EQ(word(binary) % 4, 0u);
  EXPECT_EQ(binary + 8 + word(binary), glb.size());
  EXPECT_EQ(glb.substr(binary + 4, 4), std::string("BIN\0", 4));
  EXPECT_EQ(gltf["buffers"][0]["byteLength"], word(binary));
  EXPECT_EQ(gltf["asset"]["version"], "2.0");
  EXPECT_EQ(gltf["asset"]["extras"]["exposure"], display_.exposure);
  EXPECT_EQ(gltf["extensionsUsed"][0], "KHR_materials_unlit");
  EXPECT_TRUE(gltf["materials"][0]["extensions"]["KHR_materials_unlit"].is_object());
  std::size_t end = 0;
  for (const auto& view : gltf["bufferViews"]) {
    EXPECT_EQ(view["byteOffset"], end);
    end += view["byteLength"].get<std::size_t>();
  }
  EXPECT_EQ(end, word(binary));
  for (const auto& mesh : gltf["meshes"])
    for (const auto& primitive : mesh["primitives"]) {
      const auto& positions = gltf["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
      const auto& colors = gltf["accessors"][primitive["attributes"]["COLOR_0"].get<std::size_t>()];
      const auto& indices = gltf["accessors"][primitive["indices"].get<std::size_t>()];
      EXPECT_EQ(positions["count"], colors["count"]);
      EXPECT_EQ(indices["count"].get<std::size_t>() % 3, 0u);
      const auto check_range = [&](const nlohmann::json& accessor, std::size_t size) {
        const auto& view = gltf["bufferViews"][accessor["bufferView"].get<std::size_t>()];
        EXPECT_EQ(accessor["byteOffset"].get<std::size_t>() % 4, 0u);
        EXPECT_LE(accessor["byteOffset"].get<std::size_t>() + accessor["count"].get<std::size_t>() * size,
                  view["byteLength"].get<std::size_t>());
      };
      check_range(positions, 12);
      check_range(colors, 12);
      check_range(indices, 4);
      V3f low(infinity_f), high(-infinity_f);
      for (std::size_t k = 0; k < positions["count"].get<std::size_t>(); ++k)
        for (int c = 0; c < 3; ++c) {
          float x;
          const std::size_t at =
              binary + 8 + positions["byteOffset"].get<std::size_t>() + 12 * k + 4 * std::size_t(c);
          std::memcpy(&x, glb.data() + at, 4);
          low[c] = std::min(low[c], x), high[c] = std::max(high[c], x);
        }
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(positions["min"][std::size_t(c)].get<float>(), low[c]);
        EXPECT_EQ(positions["max"][std::size_t(c)].get<float>(), high[c]);
      }
    }
}

TEST_F(MeshFiles, PlyIsReadBackByAnotherProgramsReader) {
  write_ply(file("a.ply"), display_);
  Assimp::Importer importer;
  const aiScene* read = importer.ReadFile(file("a.ply").string(), aiProcess_ValidateDataStructure);
  ASSERT_TRUE(read) << importer.GetErrorString();
  ASSERT_EQ(read->mNumMeshes, 1u);
  const aiMesh& mesh = *read->mMeshes[0];
  ASSERT_TRUE(mesh.HasVertexColors(0));
  unsigned f = 0;
  for (const DisplaySide& side : display_.sides)
    for (const V3u& t : side.triangle) {
      ASSERT_LT(f, mesh.mNumFaces);
      for (int k = 0; k < 3; ++k) {
        const unsigned i = mesh.mFaces[f].mIndices[k];
        ASSERT_EQ(V3f(mesh.mVertices[i].x, mesh.mVertices[i].y, mesh.mVertices[i].z), side.position[t[k]]);
        const C3f& color = side.color[t[k]];
        EXPECT_NEAR(srgb_decode(mesh.mColors[0][i].r), color.x, 0.006f);
        EXPECT_NEAR(srgb_decode(mesh.mColors[0][i].b), color.z, 0.006f);
      }
      ++f;
    }
  EXPECT_EQ(f, mesh.mNumFaces);
  const std::string header = content_of(file("a.ply")).substr(0, 300);
  const std::size_t exposure = header.find("comment exposure ");
  ASSERT_NE(exposure, std::string::npos);
  EXPECT_NEAR(std::stod(header.substr(exposure + 17)) / display_.exposure, 1.0, 1e-8);
}

TEST_F(MeshFiles, EmptyMeshesAndFailedWritesAreNoTrouble) {
  write_glb(file("a.glb"), {}, Scene{SceneDescription{}});
  write_ply(file("a.ply"), {});
  const std::string glb = content_of(file("a.glb"));
  const auto gltf = nlohmann::json::parse(glb.substr(20));
  EXPECT_FALSE(gltf.contains("buffers"));
  EXPECT_TRUE(contains(content_of(file("a.ply")), "element vertex 0\n"));
  EXPECT_THROW(write_glb(folder() / "nowhere" / "a.glb", display_, scene_), Error);
  EXPECT_THROW(write_ply(folder() / "nowhere" / "a.ply", display_), Error);
  EXPECT_EQ(files_in_folder(), 2u);
}

}  // namespace
}  // namespace twopass
