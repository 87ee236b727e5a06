#include "render/load/mitsuba_bsdfs.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

class MitsubaBsdfs : public LoadTest {
 protected:
  /// The material of the first bsdf of a scene.
  Material read(const std::string& body, const std::string& version = "3.0.0") const {
    const LoadedScene loaded = load_xml("<scene version='" + version + "'>\n" + body + "\n</scene>");
    return loaded.scene.materials.at(0);
  }
};

TEST_F(MitsubaBsdfs, DiffuseIsOneSided) {
  const Material material =
      read("<bsdf type='diffuse' id='red'><rgb name='reflectance' value='0.6 0.1 0.1'/></bsdf>");
  EXPECT_EQ(material.name, "red");
  EXPECT_EQ(std::get<Diffuse>(material.side[front].uniform()).reflectance, C3f(0.6f, 0.1f, 0.1f));
  EXPECT_EQ(std::get<Diffuse>(material.side[back].uniform()).reflectance, C3f(0.0f));
  EXPECT_EQ(std::get<Diffuse>(read("<bsdf type='diffuse'/>").side[front].uniform()).reflectance, C3f(0.5f));
}

TEST_F(MitsubaBsdfs, DiffuseOfOldVersions) {
  const Material material =
      read("<bsdf type='diffuse'><srgb name='diffuseReflectance' value='#ffffff'/></bsdf>", "0.5.0");
  expect_near(std::get<Diffuse>(material.side[front].uniform()).reflectance, V3f(1.0f));
}

TEST_F(MitsubaBsdfs, TwoSidedTakesOneOrTwo) {
  const std::string red = "<bsdf type='diffuse'><rgb name='reflectance' value='1 0 0'/></bsdf>";
  const Material both = read("<bsdf type='twosided'>" + red + "</bsdf>");
  EXPECT_EQ(std::get<Diffuse>(both.side[back].uniform()).reflectance, C3f(1, 0, 0));
  const Material two = read("<bsdf type='twosided' id='t'>" + red + "<bsdf type='conductor'/></bsdf>");
  EXPECT_EQ(two.name, "t");
  EXPECT_EQ(std::get<Diffuse>(two.side[front].uniform()).reflectance, C3f(1, 0, 0));
  EXPECT_TRUE(std::holds_alternative<Conductor>(two.side[back].uniform()));
  expect_error([&] { read("<bsdf type='twosided'/>"); }, {"scene.xml:2: bsdf 'twosided' holds 0 bsdfs"});
  expect_error([&] { read("<bsdf type='twosided'><bsdf type='dielectric'/></bsdf>"); },
               {"bsdf 'dielectric' has two sides already"});
  expect_error([&] { read("<bsdf type='twosided' id='a'><ref id='a'/></bsdf>"); },
               {"bsdf 'twosided' has two sides"});
}

TEST_F(MitsubaBsdfs, ConductorDefaultsToAMirror) {
  for (const char* body :
       {"<bsdf type='conductor'/>", "<bsdf type='conductor'><string name='material' value='none'/></bsdf>"}) {
    const Material material = read(body);
    const auto& metal = std::get<Conductor>(material.side[front].uniform());
    EXPECT_EQ(metal.eta, C3f(0.0f));
    EXPECT_EQ(metal.k, C3f(1.0f));
    EXPECT_EQ(metal.specular_reflectance, C3f(1.0f));
    EXPECT_TRUE(std::holds_alternative<Diffuse>(material.side[back].uniform()));
  }
}

TEST_F(MitsubaBsdfs, ConductorByIndex) {
  const std::string index = "<rgb name='eta' value='0.2 0.9 1.1'/><rgb name='k' value='3.9 2.4 2.1'/>";
  const auto metal = std::get<Conductor>(
      read("<bsdf type='conductor'>" + index + "<rgb name='specular_reflectance' value='0.9'/></bsdf>")
          .side[front].uniform());
  EXPECT_EQ(metal.eta, C3f(0.2f, 0.9f, 1.1f));
  EXPECT_EQ(metal.k, C3f(3.9f, 2.4f, 2.1f));
  EXPECT_EQ(metal.specular_reflectance, C3f(0.9f));
  const auto in_water = std::get<Conductor>(
      read("<bsdf type='conductor'>" + index + "<float name='extEta' value='2'/></bsdf>", "0.6.0").side[front].uniform());
  expect_near(in_water.k, {1.95f, 1.2f, 1.05f});
}

TEST_F(MitsubaBsdfs, ConductorPresetsAreRefused) {
  expect_error([&] { read("<bsdf type='conductor'>\n<string name='material' value='Au'/></bsdf>"); },
               {"scene.xml:3: metals by name ('Au') are not supported yet", "give eta and k"});
  expect_error([&] { read("<bsdf type='conductor'/>", "0.6.0"); }, {"metals by name ('Cu')"});
  expect_error([&] { read("<bsdf type='conductor'><rgb name='eta' value='1'/></bsdf>"); },
               {"both 'eta' and 'k'"});
  expect_error(
      [&] {
        read(
            "<bsdf type='conductor'><string name='material' value='none'/><rgb name='eta' value='1'/>"
            "<rgb name='k' value='1'/></bsdf>");
      },
      {"both 'material' and 'eta' or 'k' are given"});
}

TEST_F(MitsubaBsdfs, DielectricByNumberAndName) {
  const auto eta = [&](const std::string& properties, const std::string& version = "3.0.0") {
    const Material material = read("<bsdf type='dielectric'>" + properties + "</bsdf>", version);
    const float outside = std::get<Dielectric>(material.side[front].uniform()).eta;
    EXPECT_FLOAT_EQ(std::get<Dielectric>(material.side[back].uniform()).eta, 1.0f / outside);
    return outside;
  };
  EXPECT_FLOAT_EQ(eta(""), 1.5046f / 1.000277f);
  EXPECT_FLOAT_EQ(eta("<float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/>"), 1.5f);
  EXPECT_FLOAT_EQ(eta("<string name='int_ior' value='diamond'/><string name='ext_ior' value='vacuum'/>"),
                  2.419f);
  EXPECT_FLOAT_EQ(eta("<float name='intIOR' value='1.3'/><float name='extIOR' value='1'/>", "0.6.0"), 1.3f);
  expect_error([&] { eta("<string name='int_ior' value='jelly'/>"); },
               {"scene.xml:2: unknown index of refraction 'jelly'", "bk7"});
  expect_error([&] { eta("<float name='int_ior' value='0'/>"); }, {"an index of refraction must be positive"});
}

TEST_F(MitsubaBsdfs, DielectricColours) {
  const Material material = read(
      "<bsdf type='dielectric'><rgb name='specular_reflectance' value='0.9'/>"
      "<rgb name='specular_transmittance' value='0.8 1 1'/></bsdf>");
  for (const Side side : {front, back}) {
    EXPECT_EQ(std::get<Dielectric>(material.side[side].uniform()).specular_reflectance, C3f(0.9f));
    EXPECT_EQ(std::get<Dielectric>(material.side[side].uniform()).specular_transmittance, C3f(0.8f, 1, 1));
  }
}

TEST_F(MitsubaBsdfs, UnsupportedModelsAreRefused) {
  expect_error(
      [&] { read("<bsdf type='twosided'>\n<bsdf type='roughplastic'/></bsdf>"); },
      {"scene.xml:3: bsdf 'roughplastic' is not supported; supported bsdfs: conductor, dielectric, diffuse, "
       "twosided"});
  expect_error([&] { read("<bsdf type='diffuse'>\n<rgb name='reflectnace' value='1'/></bsdf>"); },
               {"scene.xml:3: bsdf 'diffuse' has no property 'reflectnace'; its properties: reflectance"});
}

TEST_F(MitsubaBsdfs, SharedMaterialsAreReadOnce) {
  const LoadedScene loaded = load_xml(
      "<scene version='3.0.0'><shape type='cube'><ref id='a'/></shape><shape type='sphere'><ref "
      "id='a'/></shape>"
      "<shape type='cube'/><shape type='cube'/><shape type='cube'><emitter type='area'/></shape>"
      "<bsdf type='diffuse' id='a'/></scene>");
  EXPECT_EQ(loaded.scene.materials.size(), 3u);  // a, the standard one, and black for the emitter
  EXPECT_EQ(loaded.scene.shapes[0].material, loaded.scene.shapes[1].material);
  EXPECT_EQ(loaded.scene.shapes[2].material, loaded.scene.shapes[3].material);
  const auto reflectance = [&](std::size_t shape) {
    return std::get<Diffuse>(loaded.scene.materials[loaded.scene.shapes[shape].material].side[front].uniform())
        .reflectance;
  };
  EXPECT_EQ(reflectance(2), C3f(0.5f));
  EXPECT_EQ(reflectance(4), C3f(0.0f));
}

}  // namespace
}  // namespace twopass
