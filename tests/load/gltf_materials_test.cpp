#include "render/load/gltf_materials.h"

#include "tests/load/gltf_writer.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

using json = nlohmann::json;

/// 2 x 2 pixels: red, transparent green; blue, half transparent (128 of 255) white.
const std::string png_of_four = [] {
  constexpr unsigned char bytes[] = {
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52,
      0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x06, 0x00, 0x00, 0x00, 0x72, 0xb6, 0x0d,
      0x24, 0x00, 0x00, 0x00, 0x14, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0xf8, 0xcf, 0xc0, 0xf0,
      0x1f, 0x08, 0x41, 0xe0, 0x3f, 0x08, 0x34, 0x00, 0x00, 0x3f, 0x53, 0x08, 0x79, 0x80, 0xae, 0xc0,
      0xd6, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  return std::string(reinterpret_cast<const char*>(bytes), sizeof bytes);
}();

class GltfMaterialsTest : public LoadTest {
 protected:
  /// A triangle with texture coordinates and this material.
  LoadedScene load(json material) {
    GltfWriter w = writer_;
    w.add_triangle();
    w.primitive()["attributes"]["TEXCOORD_0"] = w.add_vec2({0, 1, 1, 1, 0, 0});
    w.primitive()["attributes"]["TEXCOORD_1"] = w.add_vec2({0.5f, 0.5f, 1, 1, 0, 0});
    w.primitive()["material"] = w.add("materials", std::move(material));
    loaded_ = load_gltf(w.gltf());
    return loaded_;
  }
  /// Adds the picture as texture 0.
  void add_picture(const json& sampler = nullptr) {
    const std::vector<std::uint8_t> data(png_of_four.begin(), png_of_four.end());
    writer_.add("images", {{"bufferView", writer_.add_view(data)}, {"mimeType", "image/png"}});
    json texture{{"source", 0}};
    if (!sampler.is_null()) texture["sampler"] = writer_.add("samplers", sampler);
    writer_.add("textures", texture);
  }
  [[nodiscard]] const Material& material() const { return loaded_.scene.materials.at(0); }
  [[nodiscard]] const MaterialSide& material_side() const { return material().side[front]; }
  /// The model at texture coordinates.
  [[nodiscard]] Principled at(const V2f& uv, Side side = front) const {
    const MaterialSide& s = material().side[side];
    if (s.is_uniform()) return std::get<Principled>(s.uniform());
    ShadingGeometry geometry;
    geometry.uv = uv;
    return std::get<Principled>(s.resolve(geometry, 0.999f));
  }
  void refused(const json& material, std::initializer_list<std::string_view> parts) {
    expect_error([&] { load(material); }, parts);
  }
  static json with(const char* extension, json members) { return {{"extensions", {{extension, members}}}}; }

  GltfWriter writer_;
  LoadedScene loaded_;
};

constexpr V2f red_texel{0.25f, 0.25f}, green_texel{0.75f, 0.25f}, blue_texel{0.25f, 0.75f},
    white_texel{0.75f, 0.75f};

TEST_F(GltfMaterialsTest, TheStandardMaterialIsTheSpecifications) {
  load(json::object());
  const Principled p = at({0, 0});
  EXPECT_EQ(p.base_color, C3f(1.0f));
  EXPECT_EQ(p.metallic, 1.0f);
  EXPECT_EQ(p.roughness, 1.0f);
  EXPECT_NEAR(p.eta, 1.5f, 1e-6);
  EXPECT_EQ(at({0, 0}, back).base_color, C3f(1.0f));  // opaque: the same on both sides
}

TEST_F(GltfMaterialsTest, Factors) {
  load({{"name", "red"},
        {"pbrMetallicRoughness",
         {{"baseColorFactor", {0.5, 0.25, 0.125, 1}}, {"metallicFactor", 0.25}, {"roughnessFactor", 0.5}}}});
  EXPECT_EQ(material().name, "red");
  const Principled p = at({0, 0});
  EXPECT_EQ(p.base_color, C3f(0.5f, 0.25f, 0.125f));  // linear
  EXPECT_EQ(p.metallic, 0.25f);
  EXPECT_EQ(p.roughness, 0.5f);  // alpha = roughness^2 on both sides
  EXPECT_TRUE(loaded_.notes.empty());
  load({{"pbrMetallicRoughness", {{"metallicFactor", 7}, {"roughnessFactor", -1}}}});
  EXPECT_TRUE(has_note(loaded_, "metallicFactor 7 is rendered as 1"));
  EXPECT_TRUE(has_note(loaded_, "roughnessFactor -1 is rendered as 0"));
  refused({{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1}}}}}, {"baseColorFactor"});
}

TEST_F(GltfMaterialsTest, BaseColorTexturesAreSrgbTimesTheFactor) {
  add_picture({{"magFilter", 9728}});
  load({{"pbrMetallicRoughness",
         {{"baseColorFactor", {0.5, 0.5, 0.5, 1}},
          {"baseColorTexture", {{"index", 0}}},
          {"metallicFactor", 0}}}});
  expect_near(at(red_texel).base_color, {0.5f, 0, 0});
  expect_near(at(green_texel).base_color, {0, 0.5f, 0});
  expect_near(at(blue_texel).base_color, {0, 0, 0.5f});  // the second row lies at larger v
  expect_near(at(white_texel).base_color, C3f(0.5f));
  expect_near(at({1.25f, 0.25f}).base_color, {0.5f, 0, 0});  // repeats
}

TEST_F(GltfMaterialsTest, SamplersAndTransforms) {
  add_picture({{"magFilter", 9728}, {"wrapS", 33071}, {"wrapT", 33648}});
  json info{{"index", 0}};
  load({{"pbrMetallicRoughness", {{"baseColorTexture", info}}}});
  expect_near(at({1.25f, 0.25f}).base_color, {0, 1, 0});  // clamped
  expect_near(at({0.25f, 1.25f}).base_color, {0, 0, 1});  // mirrored
  // Scaled by 2, turned by a quarter, moved: (u, v) to (2 v, -2 u) + (0, 1).
  info["extensions"]["KHR_texture_transform"] = {{"scale", {2, 2}}, {"rotation", 0.5 * pi}, {"offset", {0, 1}}};
  load({{"pbrMetallicRoughness", {{"baseColorTexture", info}}}});
  expect_near(at({0.375f, 0.125f}).base_color, {1, 0, 0});
  expect_near(at({0.125f, 0.375f}).base_color, C3f(1.0f));
  info["extensions"]["KHR_texture_transform"] = {{"texCoord", 1}};
  load({{"pbrMetallicRoughness", {{"baseColorTexture", info}}}});
  expect_near(V3f(mesh_of(loaded_).uvs[0].x, mesh_of(loaded_).uvs[0].y, 0), {0.5f, 0.5f, 0});
  writer_.document["samplers"][0]["wrapS"] = 1;
  refused({{"pbrMetallicRoughness", {{"baseColorTexture", info}}}}, {"a sampler has the wrap mode 1"});
}

TEST_F(GltfMaterialsTest, ChannelsAreMetallicBlueAndRoughnessGreen) {
  add_picture({{"magFilter", 9728}});
  load({{"pbrMetallicRoughness",
         {{"metallicRoughnessTexture", {{"index", 0}}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.25}}}});
  EXPECT_NEAR(at(blue_texel).metallic, 0.5f, 1e-6);
  EXPECT_NEAR(at(blue_texel).roughness, 0.0f, 1e-6);
  EXPECT_NEAR(at(green_texel).metallic, 0.0f, 1e-6);
  EXPECT_NEAR(at(green_texel).roughness, 0.25f, 1e-6);
}

TEST_F(GltfMaterialsTest, SeveralSetsOfTextureCoordinates) {
  add_picture();
  load({{"pbrMetallicRoughness",
         {{"baseColorTexture", {{"index", 0}, {"texCoord", 1}}},
          {"metallicRoughnessTexture", {{"index", 0}}}}}});
  EXPECT_TRUE(has_note(loaded_, "all its textures use TEXCOORD_1"));
  EXPECT_EQ(mesh_of(loaded_).uvs[0], V2f(0.5f, 0.5f));
}

TEST_F(GltfMaterialsTest, IndexOfRefractionAndSpecular) {
  load(with("KHR_materials_ior", {{"ior", 1.33}}));
  EXPECT_NEAR(at({0, 0}).eta, 1.33f, 1e-5);
  load(with("KHR_materials_ior", {{"ior", 1.0}}));
  EXPECT_GT(at({0, 0}).eta, 1.0f);  // metals need some step
  load(with("KHR_materials_specular", {{"specularFactor", 0.25}}));
  const float eta = at({0, 0}).eta;
  EXPECT_NEAR((eta - 1) * (eta - 1) / ((eta + 1) * (eta + 1)), 0.04f * 0.25f, 1e-6);
  load(with("KHR_materials_specular", {{"specularColorFactor", {1, 0.5, 0}}}));
  EXPECT_TRUE(has_note(loaded_, "specularColorFactor is rendered as its mean"));
  load(with("KHR_materials_ior", {{"ior", 0}}));
  EXPECT_TRUE(has_note(loaded_, "ior 0"));
  refused(with("KHR_materials_ior", {{"ior", 0.5}}), {"material 0 has an index of refraction (ior) of 0.5"});
}

TEST_F(GltfMaterialsTest, TransmissionIsGlass) {
  load(with("KHR_materials_transmission", {{"transmissionFactor", 1}}));
  EXPECT_EQ(at({0, 0}).spec_trans, 1.0f);
  EXPECT_TRUE(at({0, 0}, back).inside);
  EXPECT_NEAR(at({0, 0}, back).eta, 1 / 1.5f, 1e-5);
  add_picture({{"magFilter", 9728}});
  load(with("KHR_materials_transmission",
            {{"transmissionFactor", 0.5}, {"transmissionTexture", {{"index", 0}}}}));
  EXPECT_NEAR(at(red_texel).spec_trans, 0.5f, 1e-6);
  EXPECT_NEAR(at(green_texel).spec_trans, 0.0f, 1e-6);
}

TEST_F(GltfMaterialsTest, Clearcoat) {
  load(with("KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}, {"clearcoatRoughnessFactor", 0.2}}));
  EXPECT_EQ(at({0, 0}).clearcoat, 0.5f);
  // The width of the coat: alpha = roughness^2 = 0.04 = 0.1 (1 - gloss) + 0.001 gloss.
  EXPECT_NEAR(0.1f + (0.001f - 0.1f) * at({0, 0}).clearcoat_gloss, 0.04f, 1e-6);
  load(with("KHR_materials_clearcoat", {{"clearcoatFactor", 1}, {"clearcoatRoughnessFactor", 0.9}}));
  EXPECT_TRUE(has_note(loaded_, "above 0.316"));
}

TEST_F(GltfMaterialsTest, Emission) {
  json material{{"emissiveFactor", {1, 0.5, 0}}};
  material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 10;
  load(material);
  EXPECT_EQ(loaded_.scene.shapes[0].radiance[front], C3f(10, 5, 0));
  EXPECT_EQ(loaded_.scene.shapes[0].radiance[back], C3f(0.0f));
  material["doubleSided"] = true;
  load(material);
  EXPECT_EQ(loaded_.scene.shapes[0].radiance[back], C3f(10, 5, 0));
  add_picture({{"magFilter", 9728}});
  material["doubleSided"] = false;
  material["emissiveTexture"] = {{"index", 0}};
  load(material);
  ASSERT_TRUE(loaded_.scene.shapes[0].radiance_texture);
  expect_near(color_at(*loaded_.scene.shapes[0].radiance_texture, red_texel), {10, 0, 0});
  expect_near(loaded_.scene.shapes[0].radiance[front], {5, 2.5f, 0});  // the mean
  refused({{"emissiveFactor", {1, 2}}}, {"emissiveFactor"});
}

TEST_F(GltfMaterialsTest, UnlitEmitsItsColor) {
  json material = with("KHR_materials_unlit", json::object());
  material["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 0.25, 0, 1};
  load(material);
  EXPECT_EQ(loaded_.scene.shapes[0].radiance[front], C3f(0.5f, 0.25f, 0));
  EXPECT_TRUE(is_black(std::get<Diffuse>(material_side().uniform()).reflectance));
  EXPECT_TRUE(std::holds_alternative<Null>(loaded_.scene.materials[0].side[back].uniform()));
  material["doubleSided"] = true;
  load(material);
  EXPECT_EQ(loaded_.scene.shapes[0].radiance[back], C3f(0.5f, 0.25f, 0));
  EXPECT_FALSE(std::holds_alternative<Null>(loaded_.scene.materials[0].side[back].uniform()));
}

TEST_F(GltfMaterialsTest, VertexColorsMultiplyTheBaseColor) {
  GltfWriter w;
  w.add_triangle();
  w.primitive()["attributes"]["COLOR_0"] =
      w.add_accessor("VEC4", 4, std::vector<std::uint8_t>{255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 51, 255});
  w.document["accessors"].back()["normalized"] = true;
  w.primitive()["material"] =
      w.add("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}}}});
  loaded_ = load_gltf(w.gltf());
  const auto color = [&](const Texture& texture, float u, float v) {
    return color_at(texture, TexturePoint({0, 0}, {0, 0}, MeshPlace{0, {u, v}}));
  };
  const Shape& shape = loaded_.scene.shapes.at(0);
  const auto& lit =
      std::get<TexturedModel>(loaded_.scene.materials.at(shape.material).side[front].node()->kind);
  ASSERT_EQ(lit.textures.size(), 1u);
  expect_near(color(lit.textures[0].texture, 0, 0), {0.5f, 0, 0});
  expect_near(color(lit.textures[0].texture, 1, 0), {0, 0.5f, 0});
  expect_near(color(lit.textures[0].texture, 0, 1), {0, 0, 0.1f});
  // Unlit: the colours shine.
  w.document["materials"][0]["extensions"]["KHR_materials_unlit"] = json::object();
  loaded_ = load_gltf(w.gltf());
  const Shape& unlit = loaded_.scene.shapes.at(0);
  expect_near(unlit.radiance[front], {0.5f / 3, 0.5f / 3, 0.1f / 3});
  ASSERT_TRUE(unlit.radiance_texture);
  expect_near(color(*unlit.radiance_texture, 0, 1), {0, 0, 0.1f});
}

TEST_F(GltfMaterialsTest, AlphaModes) {
  json material{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.5}}}}};
  const auto transparency = [&](const V2f& uv) { return material_side().transparency(uv); };
  load(material);
  EXPECT_EQ(transparency({0, 0}), 0.0f);  // OPAQUE ignores alpha
  material["alphaMode"] = "BLEND";
  load(material);
  EXPECT_NEAR(transparency({0, 0}), 0.5f, 1e-6);
  material["alphaMode"] = "MASK";
  load(material);
  EXPECT_EQ(transparency({0, 0}), 0.0f);  // alpha = cutoff is opaque
  material["alphaCutoff"] = 0.6;
  load(material);
  EXPECT_EQ(transparency({0, 0}), 1.0f);
  add_picture({{"magFilter", 9728}});
  material["pbrMetallicRoughness"] = {{"baseColorTexture", {{"index", 0}}}};
  material["alphaCutoff"] = 0.5;
  load(material);
  EXPECT_EQ(transparency(red_texel), 0.0f);
  EXPECT_EQ(transparency(green_texel), 1.0f);
  EXPECT_EQ(transparency(white_texel), 0.0f);  // 128 / 255
  material["alphaCutoff"] = 0.51;
  load(material);
  EXPECT_EQ(transparency(white_texel), 1.0f);
  material["alphaMode"] = "BLEND";
  load(material);
  EXPECT_NEAR(transparency(white_texel), 127 / 255.0f, 1e-5);
  EXPECT_NEAR(transparency(green_texel), 1.0f, 1e-6);
  refused({{"alphaMode", "ADD"}}, {"material 0 has alphaMode 'ADD'", "use one of: OPAQUE, MASK, BLEND"});
}

TEST_F(GltfMaterialsTest, NormalMapsStandUpright) {
  // The constant colour of this picture's red texel: (1, 0, 0), the normal (1, -1, -1) before scaling.
  add_picture({{"magFilter", 9728}});
  load({{"normalTexture", {{"index", 0}, {"scale", 0.5}}}});
  const auto* map = std::get_if<NormalMap>(&material_side().node()->kind);
  ASSERT_TRUE(map);
  const C3f color = color_at(map->normal, red_texel);
  expect_near(color * 2.0f - C3f(1.0f), {0.5f, -0.5f, -1});
  // Mirrored texture coordinates (u runs the other way): the second axis is turned.
  GltfWriter w = writer_;
  w.add_triangle();
  w.primitive()["attributes"]["TEXCOORD_0"] = w.add_vec2({1, 1, 0, 1, 1, 0});
  w.primitive()["material"] = w.add("materials", {{"normalTexture", {{"index", 0}}}});
  loaded_ = load_gltf(w.gltf());
  ASSERT_EQ(loaded_.scene.shapes.size(), 1u);
  const auto& side = loaded_.scene.materials.at(loaded_.scene.shapes[0].material).side[front];
  map = std::get_if<NormalMap>(&side.node()->kind);
  ASSERT_TRUE(map);
  expect_near(color_at(map->normal, red_texel) * 2.0f - C3f(1.0f), {1, 1, -1});
}

TEST_F(GltfMaterialsTest, TexturesThatAreNotThere) {
  writer_.add("textures", {{"source", 0}});
  const json material{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}};
  refused(material, {"material 0 refers to image 0, but there are only 0"});
  writer_.add("images", {{"uri", "none.png"}});
  refused(material, {"scene.gltf: material 0: there is no texture", "none.png"});
  writer_.document["images"][0]["uri"] = "https://example.com/a.png";
  refused(material, {"nothing is fetched from 'https:'"});
  writer_.document["images"][0]["uri"] = "data:image/png;base64,AAAA";
  refused(material, {"image 0"});
  writer_.document["textures"][0] = json::object();
  load(material);
  EXPECT_TRUE(has_note(loaded_, "texture 0 has no image"));
  refused({{"normalTexture", {{"index", 5}}}}, {"material 0 refers to texture 5"});
  refused({{"name", "steel"}, {"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", {{"index", 5}}}},
          {"material 'steel' refers to texture 5"});
}

TEST_F(GltfMaterialsTest, ExternalImages) {
  write("pictures/four of.png", png_of_four);
  writer_.add("images", {{"uri", "pictures/four%20of.png"}});
  writer_.add("textures", {{"source", 0}, {"sampler", writer_.add("samplers", {{"magFilter", 9728}})}});
  load({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  expect_near(at(blue_texel).base_color, {0, 0, 1});
}

TEST_F(GltfMaterialsTest, MaterialsThatAreNotThere) {
  GltfWriter w;
  w.add_triangle();
  w.primitive()["material"] = 3;
  expect_error([&] { load_gltf(w.gltf()); }, {"mesh 'triangle' refers to material 3, but there are only 0"});
}

}  // namespace
}  // namespace twopass
