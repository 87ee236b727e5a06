// The glTF models of Debian's package assimp-testmodels, well-formed and malformed; skipped where it is not
// installed.
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

const std::filesystem::path models = "/usr/share/assimp/models/glTF2";

TEST(GltfModels, AllLoadOrFailWithOneClearError) {
  if (!std::filesystem::exists(models)) GTEST_SKIP() << "needs Debian's assimp-testmodels";
  std::size_t loaded = 0, refused = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(models)) {
    const std::filesystem::path& path = entry.path();
    if (path.extension() != ".gltf" && path.extension() != ".glb") continue;
    try {
      const LoadedScene scene = load_scene(path, {});
      EXPECT_FALSE(scene.scene.shapes.empty()) << path;
      ++loaded;
    } catch (const Error& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(path.string() + ": ")) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(loaded, 0u);
  EXPECT_GT(refused, 0u);
}

TEST(GltfModels, TheTextureTransformTestPointsAtItsGreenMarks) {
  const std::filesystem::path path = models / "textureTransform/TextureTransformTest.gltf";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs Debian's assimp-testmodels";
  const LoadedScene loaded = load_scene(path, {});
  // The middle of each of the three offset quads shows a check mark on the colour that the offset leads to:
  // yellow is the texture's part without any offset.
  std::size_t seen = 0;
  for (const Shape& shape : loaded.scene.shapes) {
    const MaterialSide& side = loaded.scene.materials[shape.material].side[front];
    const auto* model = std::get_if<TexturedModel>(&side.node()->kind);
    if (!model || model->textures.empty() || !shape.name.starts_with("Offset")) continue;
    const Mesh& mesh = std::get<Mesh>(shape.geometry);
    V2f low(1e9f), high(-1e9f);
    for (const V2f& uv : mesh.uvs) {
      low = V2f(std::min(low.x, uv.x), std::min(low.y, uv.y));
      high = V2f(std::max(high.x, uv.x), std::max(high.y, uv.y));
    }
    const auto is_yellow = [&](const Bitmap& bitmap) {
      const C3f corner = color_at(bitmap, low + (high - low) * 0.06f);
      return corner.x > 0.3f && corner.y > 0.3f && corner.z < 0.1f;
    };
    Bitmap bitmap = std::get<Bitmap>(model->textures[0].texture);
    EXPECT_FALSE(is_yellow(bitmap)) << shape.name;
    bitmap.to_uv = {};
    EXPECT_TRUE(is_yellow(bitmap)) << shape.name;
    ++seen;
  }
  EXPECT_EQ(seen, 3u);
}

}  // namespace
}  // namespace twopass
