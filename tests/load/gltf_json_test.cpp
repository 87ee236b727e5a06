#include "render/load/gltf_json.h"

#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

nlohmann::json parse(const std::string& text) { return parse_gltf_json(text, "a.gltf"); }
void refused(const std::string& text, std::initializer_list<std::string_view> parts) {
  expect_error([&] { parse(text); }, parts);
}

TEST(GltfJson, KeepsWhatIsRenderedAndDropsTheRest) {
  const auto document = parse(R"({"asset":{"version":"2.0","extras":{"a":[1]}},"animations":[{"x":"y"}],
    "skins":7,"programs":[{"attributes":[]}],
    "materials":[{"extensions":{"KHR_materials_ior":{"ior":1.2},"VENDOR_x":{"light":"no"}}}]})");
  EXPECT_EQ(document.size(), 2u);
  EXPECT_FALSE(document["asset"].contains("extras"));
  EXPECT_EQ(document["materials"][0]["extensions"].size(), 1u);
}

TEST(GltfJson, WhatIsNoJsonIsRefused) {
  refused("", {"a.gltf: not JSON", "end of input"});
  refused("{\"asset\":", {"parse error at line 1"});
  refused("[1]", {"not a JSON object"});
  refused("{\"a\":\"\xff\"}", {"invalid"});
  refused("{\"a\":1e999}", {"not JSON"});
}

TEST(GltfJson, DepthIsBounded) {
  const auto nested = [](int depth) {
    return "{\"asset\":{\"a\":" + std::string(static_cast<std::size_t>(depth), '[') +
           std::string(static_cast<std::size_t>(depth), ']') + "}}";
  };
  EXPECT_NO_THROW(parse(nested(60)));
  refused(nested(1000000), {"nested deeper than 64 levels"});
  refused(nested(70), {"nested deeper than 64 levels"});
  EXPECT_NO_THROW(parse("{\"asset\":{\"a\":\"\\\"" + std::string(100, '[') + "\"}}"));  // in a string
}

TEST(GltfJson, MembersHaveTheirTypes) {
  refused(R"({"scene":"a"})", {"a.gltf: 'scene' is not a whole number"});
  refused(R"({"nodes":{}})", {"'nodes' is not an array of objects"});
  refused(R"({"nodes":[{"children":[0,"1"]}]})", {"'nodes[0].children' is not an array of whole numbers"});
  refused(R"({"nodes":[{},{"translation":[0,null,1]}]})",
          {"'nodes[1].translation' is not an array of numbers"});
  refused(R"({"materials":[{"doubleSided":1}]})", {"'materials[0].doubleSided' is not true or false"});
  refused(R"({"materials":[{"alphaMode":1}]})", {"'materials[0].alphaMode' is not a text"});
  refused(R"({"materials":[{"normalTexture":[]}]})", {"'materials[0].normalTexture' is not an object"});
  refused(R"({"meshes":[{"primitives":[{"attributes":{"POSITION":"0"}}]}]})", {"attributes.POSITION"});
  refused(R"({"meshes":[{"name":"m","primitives":[{}]}]})", {"mesh 'm' has a primitive without attributes"});
  refused(R"({"materials":[{"extensions":{"KHR_materials_ior":{"ior":"2"}}}]})", {"ior' is not a number"});
}

TEST(GltfJson, WholeNumbersAreWholeAndInRange) {
  refused(R"({"scene":-1})", {"'scene' is -1, not a whole number from 0 to 2^31"});
  refused(R"({"scene":0.5})", {"'scene' is 0.5"});
  refused(R"({"scene":4294967296})", {"'scene' is 4294967296"});  // 0 in 32 bits
  refused(R"({"accessors":[{"count":2147483648}]})", {"'accessors[0].count' is 2147483648"});
  refused(R"({"buffers":[{"byteLength":1e300}]})", {"not a whole number from 0 to 2^53"});
  EXPECT_EQ(parse(R"({"scene":1.0})")["scene"], 1);
  EXPECT_EQ(parse(R"({"buffers":[{"byteLength":5000000000}]})")["buffers"][0]["byteLength"], 5000000000);
  // Numbers without a point that need more than 32 bits, where they count as real ones.
  const auto light = parse(R"({"extensions":{"KHR_lights_punctual":{"lights":[{"intensity":5000000000}]}}})");
  EXPECT_TRUE(light["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"].is_number_float());
}

TEST_F(LoadTest, GltfNamesHaveNoCharacterZero) {
  expect_error([&] { load_gltf(R"({"asset":{"version":"2.0"},"nodes":[{"name":"a\u0000b"}]})"); },
               {"'nodes[0].name' has a character 0; correct the file"});
}

}  // namespace
}  // namespace twopass
