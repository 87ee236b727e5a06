#include "render/load/mtl_material.h"

#include "materials/microfacet.h"
#include "render/image/picture.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

struct Converted {
  MtlMaterial material;
  std::vector<std::string> notes;
};

/// The material that `body` describes, with textures in `folder`.
Converted convert(const std::string& body, const std::filesystem::path& folder = ".") {
  Notes notes;
  TextureFiles textures{TextureOptions{}};
  const std::filesystem::path path = folder / "a.mtl";
  const auto records = parse_mtl("newmtl m\n" + body, path.string(), {"m"}, notes);
  return {materials_of(records, path, textures, notes).at("m"), notes.lines()};
}

const MaterialSide& side(const Converted& converted, Side which = front) {
  return converted.material.material.side[which];
}
template <class Model>
const Model& model(const Converted& converted, Side which = front) {
  return std::get<Model>(side(converted, which).uniform());
}
bool has_note(const Converted& converted, std::string_view part) {
  return std::ranges::any_of(converted.notes,
                             [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

TEST(MtlMaterial, DiffuseOnBothSides) {
  const Converted m =
      convert("Kd 0.2 0.4 0.6\nKa 1 1 1\nKs 0 0 0\nNs 10\nNi 1.5\nillum 2\nd 1\nTr 0\nTf 1 1 1\n");
  expect_near(model<Diffuse>(m, front).reflectance, {0.2f, 0.4f, 0.6f});
  expect_near(model<Diffuse>(m, back).reflectance, {0.2f, 0.4f, 0.6f});
  EXPECT_TRUE(m.notes.empty());
}

TEST(MtlMaterial, EmissionIsRadiance) {
  const Converted m = convert("Kd 0.78 0.78 0.78\nKe 17 12 4\n");
  EXPECT_EQ(m.material.radiance, C3f(17, 12, 4));
  EXPECT_EQ(convert("Ke 1 1 1\n").material.radiance, C3f(1.0f));
  EXPECT_EQ(model<Diffuse>(convert("Ke 1 1 1\n")).reflectance, C3f(0.0f));
}

TEST(MtlMaterial, MissingKdIsGreyWithANote) {
  const Converted m = convert("Ns 10\n");
  expect_near(model<Diffuse>(m).reflectance, V3f(0.5f));
  EXPECT_TRUE(has_note(m, "a.mtl: no Kd: rendered with 0.5: m"));
}

TEST(MtlMaterial, HighlightsAreWardsLobe) {
  const Converted m = convert("Kd 0.5 0.4 0.3\nKs 0.2 0.3 0.4\nNs 48\nillum 2\n");
  for (const Side which : {front, back}) {
    const auto& ward = model<Ward>(m, which);
    expect_near(ward.base_reflectance, {0.5f, 0.4f, 0.3f});
    expect_near(ward.specular_reflectance, {0.2f, 0.3f, 0.4f});
    EXPECT_FLOAT_EQ(ward.alpha_u, 0.2f);  // sqrt(2 / 50)
    EXPECT_FLOAT_EQ(ward.alpha_v, 0.2f);
    EXPECT_EQ(ward.variant, WardVariant::balanced);
  }
  EXPECT_TRUE(m.notes.empty());
  for (const char* illum : {"0", "1"})
    expect_near(model<Diffuse>(convert(std::string("Kd 0.5\nKs 0.9\nillum ") + illum)).reflectance, V3f(0.5f));
  EXPECT_EQ(model<Ward>(convert("Ks 0.2\nNs 48\n")).base_reflectance, C3f(0.0f));
}

TEST(MtlMaterial, TheLobeIsAsWideAsTheSpecifications) {
  // (n.h)^Ns against exp(-tan^2 / alpha^2) at the angle where the first has fallen to a half.
  for (const float exponent : {10.0f, 100.0f, 1000.0f}) {
    const double cosine = std::pow(0.5, 1.0 / exponent), tangent2 = 1.0 / (cosine * cosine) - 1.0;
    const double alpha = beckmann_alpha_of_phong(exponent);
    EXPECT_NEAR(std::exp(-tangent2 / (alpha * alpha)), 0.5, 1.0 / exponent);
  }
}

TEST(MtlMaterial, ReflectancesAddUpToOneAtMost) {
  const Converted m = convert("Kd 1 0.5 0\nKs 1 0.5 0.25\nNs 10\n");
  expect_near(model<Ward>(m).base_reflectance, {0.5f, 0.25f, 0.0f});
  expect_near(model<Ward>(m).specular_reflectance, {0.5f, 0.25f, 0.125f});
  EXPECT_TRUE(has_note(m, "Kd + Ks above 1 reduced to 1: m"));
  const Converted above = convert("Kd 1.5 0.5 0.5\n");
  expect_near(model<Diffuse>(above).reflectance, {1.0f, 0.5f, 0.5f});
  EXPECT_TRUE(has_note(above, "reflectance above 1"));
}

TEST(MtlMaterial, MirrorsByIlluminationModel) {
  for (const char* illum : {"3", "5", "8"}) {
    const Converted m = convert(std::string("Kd 0.01 0.01 0.01\nKs 0.95 0.9 0.8\nillum ") + illum);
    expect_near(model<Conductor>(m, front).specular_reflectance, {0.95f, 0.9f, 0.8f});
    EXPECT_EQ(model<Conductor>(m, front).eta, C3f(0.0f));
    EXPECT_EQ(model<Conductor>(m, front).k, C3f(1.0f));
    expect_near(model<Conductor>(m, back).specular_reflectance, {0.95f, 0.9f, 0.8f});
    EXPECT_TRUE(has_note(m, "mirror rendered without its Kd: m"));
  }
  // Mostly diffuse: glossy.
  expect_near(model<Ward>(convert("Kd 0.6\nKs 0.3\nNs 100\nillum 3\n")).base_reflectance, V3f(0.6f));
}

TEST(MtlMaterial, GlassByIlluminationModel) {
  for (const char* illum : {"4", "6", "7", "9"}) {
    const Converted m =
        convert(std::string("Kd 0 0 0\nKs 0.3 0.3 0.3\nTf 0.25 0.16 0.09\nNi 2.5\nillum ") + illum);
    const auto& outside = model<Dielectric>(m, front);
    EXPECT_FLOAT_EQ(outside.eta, 2.5f);
    EXPECT_FLOAT_EQ(model<Dielectric>(m, back).eta, 1.0f / 2.5f);
    expect_near(outside.specular_reflectance, V3f(0.3f));
    expect_near(outside.specular_transmittance, {0.5f, 0.4f, 0.3f});  // twice through: Tf
    EXPECT_TRUE(m.notes.empty());
  }
}

TEST(MtlMaterial, GlassWithoutTfIsClear) {
  const Converted m = convert("Kd 0 0 0\nNi 1.5\nillum 7\n");
  EXPECT_EQ(model<Dielectric>(m).specular_transmittance, C3f(1.0f));
  EXPECT_EQ(model<Dielectric>(m).specular_reflectance, C3f(1.0f));
  // Tf 0 is opaque, not absent.
  EXPECT_EQ(model<Dielectric>(convert("Kd 0\nNi 1.5\nTf 0 0 0\nillum 7\n")).specular_transmittance, C3f(0.0f));
  EXPECT_NEAR(model<Dielectric>(convert("Kd 0\nNi 1.5\nd 0.36\nillum 7\n")).specular_transmittance.x, 0.8f,
              1e-6f);
}

TEST(MtlMaterial, GlassWithoutNiIsNoted) {
  const Converted m = convert("Kd 0\nillum 7\n");
  EXPECT_FLOAT_EQ(model<Dielectric>(m).eta, 1.5f);
  EXPECT_TRUE(has_note(m, "glass without Ni"));
}

TEST(MtlMaterial, DissolveIsAMask) {
  for (const char* line : {"d 0.25", "Tr 0.75", "d -halo 0.25"})
    for (const Side which : {front, back}) {
      const Converted m = convert(std::string("Kd 0.8\nillum 2\n") + line);
      EXPECT_NEAR(side(m, which).transparency(V2f(0.5f)), 0.75f, 1e-6f);
      expect_near(side(m, which).diffuse_reflectance(V2f(0.5f)), V3f(0.2f));
      EXPECT_TRUE(m.notes.empty());
    }
  EXPECT_TRUE(has_note(convert("Kd 0.8\nTr 1\n"), "invisible"));
  EXPECT_TRUE(side(convert("Kd 0.8\nd 1\n")).is_uniform());
}

TEST(MtlMaterial, TheExtensionIsPrincipled) {
  const Converted m = convert("Kd 0.8 0.6 0.4\nPr 0.3\nPm 1\nPs 0.2\nPc 0.5\nPcr 0.25\naniso 0.1\nNi 1.45\n");
  for (const Side which : {front, back}) {
    const auto& p = model<Principled>(m, which);
    expect_near(p.base_color, {0.8f, 0.6f, 0.4f});
    EXPECT_EQ(p.roughness, 0.3f);
    EXPECT_EQ(p.metallic, 1.0f);
    EXPECT_EQ(p.sheen, 0.2f);
    EXPECT_EQ(p.clearcoat, 0.5f);
    EXPECT_EQ(p.clearcoat_gloss, 0.75f);
    EXPECT_EQ(p.anisotropic, 0.1f);
    EXPECT_EQ(p.eta, 1.45f);
    EXPECT_EQ(p.spec_trans, 0.0f);
  }
  EXPECT_TRUE(m.notes.empty());
  // Roughness of Ns, no index, values out of range.
  const Converted other = convert("Kd 0.8\nNs 198\nPm 7\nNi 1\n");
  EXPECT_FLOAT_EQ(model<Principled>(other).roughness, std::sqrt(0.1f));
  EXPECT_EQ(model<Principled>(other).metallic, 1.0f);
  EXPECT_EQ(model<Principled>(other).eta, Principled{}.eta);
}

TEST(MtlMaterial, TheExtensionsGlass) {
  const Converted m = convert("Kd 1\nPr 0.1\nNi 1.5\nillum 9\nd 0.25\n");
  EXPECT_EQ(model<Principled>(m, front).spec_trans, 0.75f);
  EXPECT_TRUE(model<Principled>(m, back).inside);
}

/// Two texels wide, two high; 8 bits.
class MtlTextures : public LoadTest {
 protected:
  /// Writes a picture of 2x2 texels, from the upper left to the lower right.
  void picture(const std::string& name, const std::vector<C3f>& texels) const {
    // PPM needs no library to write.
    std::string text = "P6\n2 2\n255\n";
    for (const C3f& c : texels)
      for (int k = 0; k < 3; ++k)
        text += static_cast<char>(static_cast<unsigned char>(std::lround(c[k] * 255.0f)));
    write(name, text);
  }
  Converted convert_here(const std::string& body) const { return convert(body, folder_); }
  /// Near the centres of the texels: bottom left, bottom right, top left, top right, with v upwards.
  static constexpr float low = 0.25f, high = 0.75f;
};

const std::vector<C3f> corners_of_square{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};

TEST_F(MtlTextures, StandUpright) {
  picture("a.ppm", corners_of_square);
  const Converted m = convert_here("Kd 1 1 1\nmap_Kd a.ppm\n");
  for (const Side which : {front, back}) {
    const auto at = [&](float u, float v) { return side(m, which).diffuse_reflectance(V2f(u, v)); };
    expect_near(at(low, high), {1, 0, 0});  // the first row is the upper one
    expect_near(at(high, high), {0, 1, 0});
    expect_near(at(low, low), {0, 0, 1});
    expect_near(at(high, low), {1, 1, 1});
    expect_near(at(1.0f + low, high - 3.0f), {1, 0, 0});  // repeats
  }
}

TEST_F(MtlTextures, OptionsMoveScaleAndClamp) {
  picture("a.ppm", corners_of_square);
  const auto at = [&](const std::string& options, float u, float v) {
    return side(convert_here("Kd 1 1 1\nmap_Kd " + options + " a.ppm\n")).diffuse_reflectance(V2f(u, v));
  };
  expect_near(at("-o 0.5 0 0", low, high), {0, 1, 0});
  expect_near(at("-o 0 0.5 0", low, low), {1, 0, 0});
  expect_near(at("-s 2 2 1", 0.125f, 0.375f), {1, 0, 0});
  expect_near(at("-clamp on", 7.0f, 7.0f), {0, 1, 0});
  expect_near(at("-clamp on", -7.0f, -7.0f), {0, 0, 1});
  expect_near(at("-mm 0.25 0.5", low, high), {0.75f, 0.25f, 0.25f});
  expect_near(at("-mm 0.25 2", low, high), {1.0f, 0.25f, 0.25f});  // limited
}

TEST_F(MtlTextures, MultiplyColours) {
  picture("a.ppm", corners_of_square);
  const auto at = [&](const std::string& kd) {
    return side(convert_here(kd + "map_Kd a.ppm\n")).diffuse_reflectance(V2f(high, low));
  };
  expect_near(at("Kd 0.5 0.25 0.125\n"), {0.5f, 0.25f, 0.125f});
  expect_near(at("Kd 0 0 0\n"), {1, 1, 1});
  expect_near(at(""), {1, 1, 1});
}

TEST_F(MtlTextures, ColoursAreSrgbNumbersRaw) {
  picture("grey.ppm", {C3f(0.5f), C3f(0.5f), C3f(0.5f), C3f(0.5f)});
  const float byte = 128.0f / 255.0f, linear = std::pow((byte + 0.055f) / 1.055f, 2.4f);
  expect_near(side(convert_here("map_Kd grey.ppm\n")).diffuse_reflectance(V2f(low, low)), V3f(linear));
  EXPECT_NEAR(side(convert_here("Kd 1\nmap_d grey.ppm\n")).transparency(V2f(low, low)), 1.0f - byte, 1e-5f);
  EXPECT_NEAR(side(convert_here("Kd 1\nd 0.5\nmap_d grey.ppm\n")).transparency(V2f(low, low)),
              1.0f - 0.5f * byte, 1e-5f);
}

TEST_F(MtlTextures, EmissionVaries) {
  picture("a.ppm", corners_of_square);
  const MtlMaterial m = convert_here("Ke 4 4 4\nmap_Ke -mm 0 0.5 a.ppm\n").material;
  ASSERT_TRUE(m.radiance_texture);
  expect_near(color_at(*m.radiance_texture, V2f(low, high)), {2, 0, 0});
  expect_near(m.radiance, V3f(1.0f));  // half of the texels in each channel
}

TEST_F(MtlTextures, EveryMapReachesItsParameter) {
  picture("a.ppm", corners_of_square);
  for (const char* body : {"Kd .5\nKs .2\nNs 10\nmap_Ks a.ppm", "Kd .5\nKs .2\nNs 10\nmap_Ns a.ppm",
                           "Kd .5\nbump -bm 0.1 a.ppm", "Kd .5\nnorm a.ppm", "Kd .5\nmap_Pr a.ppm",
                           "Kd .5\nmap_Pm a.ppm", "Kd .5\nmap_Ps a.ppm", "Ks 1\nillum 3\nmap_Ks a.ppm"}) {
    const Converted m = convert_here(body);
    EXPECT_TRUE(side(m).traits().needs_uv) << body;
    EXPECT_TRUE(m.notes.empty()) << body << ": " << m.notes[0];
  }
}

TEST_F(MtlTextures, GlossFollowsItsMap) {
  picture("a.ppm", {C3f(1.0f), C3f(0.0f), C3f(1.0f), C3f(0.0f)});
  const Converted m = convert_here("Kd .5\nKs .2\nNs 48\nmap_Ks a.ppm");
  ShadingGeometry at;
  at.uv = {low, low};
  expect_near(std::get<Ward>(side(m).resolve(at, 0.5f)).specular_reflectance, V3f(0.2f));
  at.uv = {high, low};
  expect_near(std::get<Ward>(side(m).resolve(at, 0.5f)).specular_reflectance, V3f(0.0f));
  const Converted exponents = convert_here("Kd .5\nKs .2\nNs 48\nmap_Ns a.ppm");
  at.uv = {low, low};
  EXPECT_NEAR(std::get<Phong>(side(exponents).resolve(at, 0.5f)).exponent, 12.0f, 1e-4f);
}

TEST_F(MtlTextures, MissingOnesNameWhoAsked) {
  expect_error([&] { convert_here("Kd 1\nmap_Kd none.png\n"); }, {"a.mtl:3", "none.png"});
}

}  // namespace
}  // namespace twopass
