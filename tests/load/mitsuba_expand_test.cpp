#include "render/load/mitsuba_expand.h"

#include <sys/stat.h>

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

std::string numbered(int i) { return std::string("n").append(std::to_string(i)).append(".xml"); }
std::string include_of(int i) { return std::string("<include filename='").append(numbered(i)).append("'/>"); }

class MitsubaExpand : public LoadTest {
 protected:
  MitsubaTree read(std::string_view text, const Definitions& definitions = {}) const {
    return read_mitsuba(write("scene.xml", text), definitions);
  }
  MitsubaTree read_body(const std::string& body, const Definitions& definitions = {}) const {
    return read("<scene version='3.0.0'>\n" + body + "\n</scene>", definitions);
  }
};

TEST_F(MitsubaExpand, TheVersionIsMandatory) {
  expect_error([&] { read("<scene/>"); }, {"scene.xml:1: <scene> has no version", "version=\"3.0.0\""});
  for (const char* version : {"", "x", "0.3.0", "4.0.0", "3.x", "1.2.3.4", "-1"})
    expect_error([&] { read(std::string("<scene version='") + version + "'/>"); },
                 {"scene.xml:1: version '", "supported: 0.4.0 to 3.x"});
  for (const char* version : {"0.4.0", "0.5.0", "0.6.0", "1.0.0", "2.1.0", "3", "3.8.1"})
    EXPECT_NO_THROW(read(std::string("<scene version='") + version + "'/>")) << version;
}

TEST_F(MitsubaExpand, TheRootIsAScene) {
  expect_error([&] { read("<shape type='cube'/>"); }, {"scene.xml:1: the root element is <shape>"});
}

TEST_F(MitsubaExpand, ParametersAreReplacedAnywhere) {
  const std::string body =
      "<default name='dir' value='a'/><default name='dirs' value='b'/>"
      "<default name='both' value='$dir-$dirs'/>"
      "<shape type='$dir$dirs' id='x_$both'><integer name='n' value='4$dir'/></shape>";
  const MitsubaTree tree = read_body(body);
  const XmlNode& shape = tree.root.children.at(0);
  EXPECT_EQ(shape.get("type"), "ab");
  EXPECT_EQ(shape.get("id"), "x_a-b");
  EXPECT_EQ(shape.children[0].get("value"), "4a");
  EXPECT_EQ(read_body(body, {{"dir", "Z"}}).root.children[0].get("type"), "Zb");
}

TEST_F(MitsubaExpand, ParametersReachTransformsAndFirstDefaultsCount) {
  const MitsubaTree tree = read_body(
      "<default name='s' value='2'/><default name='s' value='3'/>"
      "<shape type='cube'><transform name='to_world'><scale value='$s'/></transform></shape>");
  EXPECT_EQ(tree.root.children[0].children[0].children[0].get("value"), "2");
}

// Everything that a scene names goes through find_file: meshes, textures, profiles, includes.
TEST_F(MitsubaExpand, OnlyRegularFilesMayBeNamed) {
  ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  std::filesystem::create_directories(folder_ / "folder");
  const std::pair<const char*, const char*> names[] = {
      {"pipe", "not a regular file but a pipe"}, {"folder", "this is a folder"}, {"/dev/zero", "a device"}};
  for (const auto& [name, what] : names) {
    const std::string file = "value='" + std::string(name) + "'/>";
    for (const std::string& user : {"<include\nfilename='" + std::string(name) + "'/>",
                                    "<shape type='obj'>\n<string name='filename' " + file + "</shape>",
                                    "<emitter type='envmap'>\n<string name='filename' " + file + "</emitter>",
                                    "<bsdf type='diffuse'><texture name='reflectance' type='bitmap'>\n"
                                    "<string name='filename' " +
                                        file + "</texture></bsdf>"})
      expect_error([&] { load_xml("<scene version='3.0.0'>\n" + user + "\n</scene>"); },
                   {"scene.xml:", name, what});
  }
}

TEST_F(MitsubaExpand, FilesAreFoundInAnyCase) {
  write("Meshes/Part.XML", "<scene version='3.0.0'><shape type='cube'/></scene>");
  EXPECT_EQ(read_body("<include filename='meshes\\part.xml'/>").root.children.at(0).get("type"), "cube");
}

TEST_F(MitsubaExpand, UnknownParametersAreErrors) {
  expect_error([&] { read_body("<default name='b' value='1'/>\n<shape type='$a'/>"); },
               {"scene.xml:3: parameter '$a' has no value", "give -D a=VALUE", "known here: b"});
  // A default must come before its use.
  expect_error([&] { read_body("<shape type='$a'/><default name='a' value='1'/>"); },
               {"scene.xml:2: parameter '$a'"});
}

TEST_F(MitsubaExpand, DefinitionsThatNothingUsesAreErrors) {
  expect_error(
      [&] {
        read_body("<default name='spp' value='1'/><default name='size' value='1'/>", {{"ssp", "4"}});
      },
      {"-D ssp: the scene has no such parameter", "its parameters: size, spp"});
}

TEST_F(MitsubaExpand, IncludesAreSpliced) {
  write("sub/part.xml",
        "<scene version='3.0.0'><include filename='deep.xml'/><shape type='$t' id='b'/></scene>");
  write("sub/deep.xml", "<scene><default name='t' value='cube'/><shape type='sphere' id='a'/></scene>");
  const MitsubaTree tree = read_body("<include filename='sub/part.xml'/><shape type='$t' id='c'/>");
  ASSERT_EQ(tree.root.children.size(), 3u);
  EXPECT_EQ(tree.root.children[0].get("id"), "a");
  EXPECT_EQ(tree.root.children[1].get("type"), "cube");
  EXPECT_EQ(tree.root.children[2].get("type"), "cube");
  EXPECT_EQ(tree.objects.at("a"), &tree.root.children[0]);
  EXPECT_NE(tree.root.children[0].where().find("deep.xml:1"), std::string::npos);
}

TEST_F(MitsubaExpand, IncludesHaveTheirOwnVersion) {
  write(
      "old.xml",
      "<scene version='0.6.0'><bsdf type='diffuse'><rgb name='diffuseReflectance' value='1'/></bsdf></scene>");
  write("same.xml", "<scene><sensor type='x'><float name='nearClip' value='1'/></sensor></scene>");
  const MitsubaTree tree = read_body("<include filename='old.xml'/><include filename='same.xml'/>");
  EXPECT_EQ(tree.root.children[0].children[0].get("name"), "reflectance");
  EXPECT_EQ(tree.root.children[1].children[0].get("name"), "nearClip");
}

TEST_F(MitsubaExpand, IncludesThatNeverEndAreErrors) {
  write("a.xml", "<scene>\n<include filename='b.xml'/></scene>");
  write("b.xml", "<scene>\n\n<include filename='a.xml'/></scene>");
  expect_error([&] { read_body("<include filename='a.xml'/>"); }, {"b.xml:3:", "includes itself"});
  for (int i = 0; i < 20; ++i) write(numbered(i), "<scene>" + include_of(i + 1) + "</scene>");
  expect_error([&] { read_body(include_of(0)); }, {"includes are nested more than 15 deep"});
  expect_error([&] { read_body("<include filename='none.xml'/>"); },
               {"scene.xml:2: there is no file 'none.xml'", "searched: "});
}

TEST_F(MitsubaExpand, IncludesThatMultiplyAreErrors) {
  for (int i = 0; i < 14; ++i) {
    const std::string next = include_of(i + 1);
    write(numbered(i), "<scene>" + next + next + next + "</scene>");
  }
  write(numbered(14), "<scene/>");
  expect_error([&] { read_body(include_of(0)); }, {"more than 1000 files are included"});
}

TEST_F(MitsubaExpand, PathsAreSearched) {
  write("assets/part.xml", "<scene><shape type='cube'/></scene>");
  EXPECT_EQ(read_body("<path value='assets'/><include filename='part.xml'/>").root.children.size(), 1u);
  expect_error([&] { read_body("<path value='none'/>"); }, {"scene.xml:2: there is no folder"});
}

TEST_F(MitsubaExpand, AliasesAndReferences) {
  const MitsubaTree tree = read_body(
      "<bsdf type='twosided' id='a'><bsdf type='diffuse' id='inner'/></bsdf>"
      "<alias id='a' as='b'/><shape type='cube'><ref id='b'/></shape>");
  EXPECT_EQ(&resolve(tree, tree.root.children[1].children[0]), &tree.root.children[0]);
  EXPECT_EQ(tree.objects.at("inner")->get("type"), "diffuse");
  expect_error([&] { read_body("<alias id='x' as='y'/>"); }, {"scene.xml:2: there is no object 'x'"});
}

TEST_F(MitsubaExpand, IdsAreUnique) {
  expect_error([&] { read_body("<bsdf type='diffuse' id='a'/>\n<shape type='cube' id='a'/>"); },
               {"scene.xml:3: id 'a' is used twice, first at ", "scene.xml:2"});
}

TEST_F(MitsubaExpand, UnknownReferencesListSomeIds) {
  std::string body = "<ref id='x'/>";
  for (int i = 10; i < 40; ++i) body += "<bsdf type='diffuse' id='b" + std::to_string(i) + "'/>";
  const MitsubaTree tree = read_body(body);
  expect_error([&] { resolve(tree, tree.root.children[0]); },
               {"scene.xml:2: there is no object with the id 'x'", "known ids: b10, b11,", "b21, ..."});
}

TEST_F(MitsubaExpand, UnknownElementsAreErrors) {
  expect_error(
      [&] { read_body("<camera type='perspective'/>"); },
      {"scene.xml:2: unknown element <camera>", "objects: bsdf, emitter", "properties: boolean, float"});
}

TEST_F(MitsubaExpand, OldNamesBecomeNew) {
  EXPECT_EQ(snake_case("toWorld"), "to_world");
  EXPECT_EQ(snake_case("intIOR"), "int_ior");
  EXPECT_EQ(snake_case("fovAxis"), "fov_axis");
  EXPECT_EQ(snake_case("kNN"), "k_nn");
  EXPECT_EQ(snake_case("diffuse_reflectance"), "diffuse_reflectance");
  EXPECT_EQ(snake_case("principalPointOffsetX"), "principal_point_offset_x");
}

}  // namespace
}  // namespace twopass
