#include "render/load/mitsuba_bsdfs.h"

#include "materials/conductor_presets.h"
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
               {"scene.xml:2: this <bsdf> refers to itself"});
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
          .side[front]
          .uniform());
  EXPECT_EQ(metal.eta, C3f(0.2f, 0.9f, 1.1f));
  EXPECT_EQ(metal.k, C3f(3.9f, 2.4f, 2.1f));
  EXPECT_EQ(metal.specular_reflectance, C3f(0.9f));
  const auto in_water = std::get<Conductor>(
      read("<bsdf type='conductor'>" + index + "<float name='extEta' value='2'/></bsdf>", "0.6.0")
          .side[front]
          .uniform());
  expect_near(in_water.k, {1.95f, 1.2f, 1.05f});
}

TEST_F(MitsubaBsdfs, ConductorsByName) {
  const Material gold = read("<bsdf type='conductor'><string name='material' value='Au'/></bsdf>");
  EXPECT_EQ(std::get<Conductor>(gold.side[front].uniform()).k, conductor_index_of("Au", "").k);
  // Mitsuba 1 took copper for granted.
  const Material copper = read("<bsdf type='roughconductor'/>", "0.6.0");
  EXPECT_EQ(std::get<RoughConductor>(copper.side[front].uniform()).eta, conductor_index_of("Cu", "").eta);
  expect_error([&] { read("<bsdf type='conductor'>\n<string name='material' value='Xx'/></bsdf>"); },
               {"scene.xml:3:", "'Xx'", "Au"});
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
  expect_error([&] { read("<bsdf type='twosided'>\n<bsdf type='hair'/></bsdf>"); },
               {"scene.xml:3: bsdf 'hair' is not supported; supported bsdfs: blendbsdf, bumpmap, conductor, "
                "dielectric"});
  expect_error([&] { read("<bsdf type='diffuse'>\n<rgb name='reflectnace' value='1'/></bsdf>"); },
               {"scene.xml:3: bsdf 'diffuse' has no property 'reflectnace'; its properties: reflectance"});
}

// Every model by its defaults, in the variant's order.
TEST_F(MitsubaBsdfs, EveryModelHasAPlugin) {
  for (std::size_t i = 0; i < std::size(model_names); ++i) {
    const Material material = read("<bsdf type='" + std::string(model_names[i]) + "'/>");
    ASSERT_TRUE(material.side[front].is_uniform()) << model_names[i];
    EXPECT_EQ(material.side[front].uniform().index(), i) << model_names[i];
  }
}

TEST_F(MitsubaBsdfs, ParametersAreReadByName) {
  const Material plastic = read(
      "<bsdf type='roughplastic'><rgb name='diffuse_reflectance' value='.1,.2,.3'/><float name='alpha' "
      "value='.3'/>"
      "<string name='distribution' value='ggx'/><boolean name='nonlinear' value='true'/>"
      "<float name='int_ior' value='1.5'/><float name='ext_ior' value='1'/></bsdf>");
  const auto& model = std::get<RoughPlastic>(plastic.side[front].uniform());
  EXPECT_EQ(model.base_reflectance, C3f(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(model.alpha, 0.3f);
  EXPECT_EQ(model.distribution, Microfacet::ggx);
  EXPECT_TRUE(model.nonlinear);
  EXPECT_EQ(model.eta, 1.5f);
  const Material metal = read(
      "<bsdf type='roughconductor'><float name='alpha_u' value='.1'/><float name='alpha_v' "
      "value='.4'/></bsdf>");
  EXPECT_EQ(std::get<RoughConductor>(metal.side[front].uniform()).alpha_v, 0.4f);
  const Material disney = read("<bsdf type='principled'><float name='specular' value='.2'/></bsdf>");
  EXPECT_EQ(std::get<Principled>(disney.side[front].uniform()).eta, eta_of_specular(0.2f));
  expect_error([&] { read("<bsdf type='principled'>\n<float name='roughness' value='1.5'/></bsdf>"); },
               {"scene.xml:3: roughness is out of range; must be between 0 and 1"});
  expect_error(
      [&] {
        read("<bsdf type='ward'>\n<float name='alpha' value='.1'/><float name='alpha_u' value='.1'/></bsdf>");
      },
      {"scene.xml:3: 'alpha' is given together with"});
  expect_error([&] { read("<bsdf type='roughplastic'>\n<string name='distribution' value='blinn'/></bsdf>"); },
               {"scene.xml:3:", "beckmann", "ggx"});
}

TEST_F(MitsubaBsdfs, HeuristicModelsKeepTheirEnergy) {
  const Material phong = read(
      "<bsdf type='phong'><rgb name='diffuse_reflectance' value='1'/><rgb name='specular_reflectance' "
      "value='1'/></bsdf>");
  EXPECT_FLOAT_EQ(std::get<Phong>(phong.side[front].uniform()).base_reflectance.x, 0.495f);
  const Material ward = read("<bsdf type='ward'/>");
  EXPECT_EQ(std::get<Ward>(ward.side[front].uniform()).base_reflectance.x, 0.5f);
}

TEST_F(MitsubaBsdfs, PhongsFacetsAreBeckmanns) {
  const Material metal = read("<bsdf type='roughconductor'><string name='distribution' value='phong'/></bsdf>");
  EXPECT_EQ(std::get<RoughConductor>(metal.side[front].uniform()).distribution, Microfacet::beckmann);
}

TEST_F(MitsubaBsdfs, RoughGlassNeedsAStepOfTheIndex) {
  expect_error(
      [&] {
        read(
            "<bsdf type='roughdielectric'>\n<float name='int_ior' value='1.3'/><float name='ext_ior' "
            "value='1.3'/></bsdf>");
      },
      {"scene.xml:3: a rough interface needs two different indices"});
}

TEST_F(MitsubaBsdfs, TexturesMixturesAndMaps) {
  const std::string board = "<texture name='NAME' type='checkerboard'><rgb name='color0' value='1'/></texture>";
  const auto named = [&](const std::string& name) {
    std::string text = board;
    return text.replace(text.find("NAME"), 4, name);
  };
  const Material textured = read("<bsdf type='diffuse'>" + named("reflectance") + "</bsdf>");
  EXPECT_FALSE(textured.side[front].is_uniform());
  EXPECT_FLOAT_EQ(textured.side[front].diffuse_reflectance(V2f(0.1f, 0.1f)).x, 1.0f);
  EXPECT_FLOAT_EQ(textured.side[front].diffuse_reflectance(V2f(0.6f, 0.1f)).x, 0.2f);
  const Material mask =
      read("<bsdf type='mask'><float name='opacity' value='.25'/><bsdf type='diffuse'/></bsdf>");
  EXPECT_FLOAT_EQ(mask.side[front].transparency(V2f(0, 0)), 0.75f);
  EXPECT_FLOAT_EQ(mask.side[back].transparency(V2f(0, 0)), 0.75f);
  const Material blend = read(
      "<bsdf type='blendbsdf'><float name='weight' value='.25'/><bsdf type='diffuse'/><bsdf "
      "type='conductor'/></bsdf>");
  EXPECT_FLOAT_EQ(blend.side[front].traits().mean_diffuse_reflectance.x, 0.375f);
  const Material mixture = read(
      "<bsdf type='mixturebsdf'><string name='weights' value='.2, .3'/><bsdf type='diffuse'/>"
      "<bsdf type='diffuse'><rgb name='reflectance' value='1'/></bsdf></bsdf>");
  EXPECT_FLOAT_EQ(mixture.side[front].traits().mean_diffuse_reflectance.x, 0.2f * 0.5f + 0.3f);
  const Material bump = read("<bsdf type='bumpmap'>" + named("height") +
                             "<bsdf type='twosided'><bsdf type='diffuse'/></bsdf></bsdf>");
  EXPECT_FLOAT_EQ(bump.side[back].traits().mean_diffuse_reflectance.x, 0.5f);
  expect_error([&] { read("<bsdf type='bumpmap'>\n<bsdf type='diffuse'/></bsdf>"); }, {"holds no texture"});
  expect_error([&] { read("<bsdf type='mask'/>"); }, {"bsdf 'mask' holds no bsdf"});
  expect_error([&] { read("<bsdf type='blendbsdf'><bsdf type='diffuse'/><bsdf type='diffuse'/></bsdf>"); },
               {"has no weight"});
  expect_error(
      [&] {
        read(
            "<bsdf type='diffuse'><texture name='reflectance' type='bitmap'>\n<string name='filename' "
            "value='no.png'/></texture></bsdf>");
      },
      {"scene.xml:3:", "no.png"});
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
