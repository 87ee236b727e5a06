#include "render/load/mtl_material.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

struct Parsed {
  MtlMaterial material;
  std::vector<std::string> notes;
};

/// The material that `body` describes.
Parsed parse(const std::string& body) {
  Notes notes;
  MtlLibrary library =
      parse_mtl("newmtl m\n" + body, "a.mtl", {"m", "a", "b", "c", "d", "e", "f", "my mat"}, notes);
  EXPECT_EQ(library.size(), 1u);
  return {library.at("m"), notes.lines()};
}

template <class Model>
const Model& side(const Parsed& parsed, Side which) {
  return std::get<Model>(parsed.material.material.side[which].uniform());
}

TEST(MtlMaterial, DiffuseOnBothSides) {
  const Parsed parsed =
      parse("Kd 0.2 0.4 0.6\nKa 1 1 1\nKs 0 0 0\nNs 10\nNi 1.5\nillum 2\nd 1\nTr 0\nTf 1 1 1\n");
  expect_near(side<Diffuse>(parsed, front).reflectance, {0.2f, 0.4f, 0.6f});
  expect_near(side<Diffuse>(parsed, back).reflectance, {0.2f, 0.4f, 0.6f});
  EXPECT_TRUE(parsed.notes.empty());
}

TEST(MtlMaterial, OneNumberIsGrey) {
  expect_near(side<Diffuse>(parse("Kd 0.3 # comment\n"), front).reflectance, V3f(0.3f));
}

TEST(MtlMaterial, EmissionIsRadiance) {
  const Parsed parsed = parse("Kd 0.78 0.78 0.78\nKe 17 12 4\n");
  EXPECT_EQ(parsed.material.radiance, C3f(17, 12, 4));
  EXPECT_EQ(parse("Ke 1 1 1\n").material.radiance, C3f(1.0f));
  EXPECT_EQ(side<Diffuse>(parse("Ke 1 1 1\n"), front).reflectance, C3f(0.0f));
}

TEST(MtlMaterial, MissingKdIsGreyWithANote) {
  const Parsed parsed = parse("Ns 10\n");
  expect_near(side<Diffuse>(parsed, front).reflectance, V3f(0.5f));
  EXPECT_EQ(parsed.notes, (std::vector<std::string>{"a.mtl: no Kd: rendered with 0.5: m"}));
}

TEST(MtlMaterial, MirrorsByIlluminationModel) {
  for (const char* illum : {"3", "5", "8"}) {
    const Parsed parsed = parse(std::string("Kd 0.01 0.01 0.01\nKs 0.95 0.9 0.8\nillum ") + illum);
    expect_near(side<Conductor>(parsed, front).specular_reflectance, {0.95f, 0.9f, 0.8f});
    EXPECT_EQ(side<Conductor>(parsed, front).eta, C3f(0.0f));
    EXPECT_EQ(side<Conductor>(parsed, front).k, C3f(1.0f));
    expect_near(side<Conductor>(parsed, back).specular_reflectance, {0.95f, 0.9f, 0.8f});
    EXPECT_EQ(parsed.notes, (std::vector<std::string>{"a.mtl: mirror rendered without its Kd: m"}));
  }
  // Mostly diffuse: stays so.
  const Parsed parsed = parse("Kd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nillum 3\n");
  expect_near(side<Diffuse>(parsed, front).reflectance, V3f(0.8f));
  EXPECT_EQ(parsed.notes.size(), 1u);
}

TEST(MtlMaterial, GlassByIlluminationModel) {
  for (const char* illum : {"4", "6", "7", "9"}) {
    const Parsed parsed =
        parse(std::string("Kd 0 0 0\nKs 0.3 0.3 0.3\nTf 0.25 0.16 0.09\nNi 2.5\nillum ") + illum);
    const auto& outside = side<Dielectric>(parsed, front);
    EXPECT_FLOAT_EQ(outside.eta, 2.5f);
    EXPECT_FLOAT_EQ(side<Dielectric>(parsed, back).eta, 1.0f / 2.5f);
    expect_near(outside.specular_reflectance, V3f(0.3f));
    expect_near(outside.specular_transmittance, {0.5f, 0.4f, 0.3f});  // twice through: Tf
    EXPECT_TRUE(parsed.notes.empty());
  }
}

TEST(MtlMaterial, GlassWithoutTfIsClear) {
  const Parsed parsed = parse("Kd 0 0 0\nNi 1.5\nillum 7\n");
  EXPECT_EQ(side<Dielectric>(parsed, front).specular_transmittance, C3f(1.0f));
  EXPECT_EQ(side<Dielectric>(parsed, front).specular_reflectance, C3f(1.0f));
  // Tf 0 is opaque, not absent.
  EXPECT_EQ(side<Dielectric>(parse("Kd 0\nNi 1.5\nTf 0 0 0\nillum 7\n"), front).specular_transmittance,
            C3f(0.0f));
}

TEST(MtlMaterial, GlassWithoutNiIsNoted) {
  const Parsed parsed = parse("Kd 0\nillum 7\n");
  EXPECT_FLOAT_EQ(side<Dielectric>(parsed, front).eta, 1.5f);
  EXPECT_EQ(parsed.notes.size(), 1u);
}

TEST(MtlMaterial, DissolveIsASheetOfGlass) {
  for (const char* line : {"d 0.36", "Tr 0.64", "d -halo 0.36"}) {
    const Parsed parsed = parse(std::string("Kd 0 0 0\nillum 2\n") + line);
    EXPECT_FLOAT_EQ(side<Dielectric>(parsed, front).eta, 1.0f);
    EXPECT_NEAR(side<Dielectric>(parsed, front).specular_transmittance.x, 0.8f, 1e-6f);
    EXPECT_EQ(parsed.notes.size(), 1u);
  }
}

TEST(MtlMaterial, HighlightsAreNoted) {
  EXPECT_EQ(parse("Kd 0.5 0.5 0.5\nKs 0.9 0.9 0.9\nNs 40\nillum 2\n").notes,
            (std::vector<std::string>{"a.mtl: highlights (Ks, Ns) are left out: m"}));
  EXPECT_TRUE(parse("Kd 0.5 0.5 0.5\nKs 0.9 0.9 0.9\nillum 1\n").notes.empty());
}

TEST(MtlMaterial, TexturesAreNotedByName) {
  Notes notes;
  std::string text;
  for (const char* name : {"a", "b", "c", "d", "e", "f"})
    text += std::string("newmtl ") + name + "\nKd 1 1 1\nmap_Kd wall.png\n";
  parse_mtl(text, "a.mtl", {"m", "a", "b", "c", "d", "e", "f", "my mat"}, notes);
  EXPECT_EQ(notes.lines(),
            (std::vector<std::string>{
                "a.mtl: textures are not supported, plain colours used: a, b, c, d and 2 more"}));
}

TEST(MtlMaterial, ReflectancesAboveOneAreReduced) {
  const Parsed parsed = parse("Kd 1.5 0.5 0.5\n");
  expect_near(side<Diffuse>(parsed, front).reflectance, {1.0f, 0.5f, 0.5f});
  EXPECT_EQ(parsed.notes.size(), 1u);
}

TEST(MtlMaterial, NamesMayContainSpaces) {
  Notes notes;
  const MtlLibrary library = parse_mtl("\xEF\xBB\xBFnewmtl my mat \r\n\tKd 1 0 0\r\nnewmtl b\nKd 0 1 0",
                                       "a.mtl", {"m", "a", "b", "c", "d", "e", "f", "my mat"}, notes);
  EXPECT_TRUE(library.contains("my mat"));
  EXPECT_TRUE(library.contains("b"));
}

TEST(MtlMaterial, RefusesMalformedNumbers) {
  expect_error([] { parse("Kd 0.5 x 1\n"); }, {"a.mtl:2: 'Kd' cannot be 'x'"});
  expect_error([] { parse("\nKd -0.5 0 0\n"); }, {"a.mtl:3: 'Kd' cannot be '-0.5'"});
  expect_error([] { parse("Ke nan 0 0\n"); }, {"a.mtl:2: 'Ke' cannot be 'nan'"});
  expect_error([] { parse("Kd 1 1\n"); }, {"a.mtl:2: 'Kd' needs one or three numbers"});
  expect_error([] { parse("Kd\n"); }, {"a.mtl:2: 'Kd' needs one or three numbers"});
  expect_error([] { parse("Ni\n"); }, {"a.mtl:2: 'Ni' without a number"});
  expect_error([] { parse("Kd spectral a.rfl\n"); }, {"a.mtl:2: 'Kd' with 'spectral' is not supported"});
  expect_error([] { parse("newmtl\n"); }, {"a.mtl:2: 'newmtl' without a name"});
}

TEST(MtlMaterial, OnlyWantedMaterialsAreConverted) {
  Notes notes;
  const MtlLibrary library = parse_mtl("newmtl a\nKd 2 2 2\nnewmtl b\nKd 0 1 0\n", "a.mtl", {"b"}, notes);
  EXPECT_EQ(library.size(), 1u);
  EXPECT_TRUE(library.contains("b"));
  EXPECT_TRUE(notes.lines().empty());
}

}  // namespace
}  // namespace twopass
