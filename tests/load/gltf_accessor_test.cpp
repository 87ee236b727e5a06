#include "render/load/gltf_accessor.h"

#include "tests/load/gltf_writer.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

GltfDocument parse(const GltfWriter& writer) {
  Notes notes;
  return parse_gltf(writer.gltf(), "a.gltf", notes);
}
std::vector<float> numbers(const GltfDocument& document, int index) {
  const GltfAccessor accessor(document, index, "test");
  std::vector<float> result;
  for (std::size_t i = 0; i < accessor.count(); ++i)
    for (int c = 0; c < accessor.components(); ++c) result.push_back(accessor.number(i, c));
  return result;
}
void refused(const GltfWriter& writer, std::initializer_list<std::string_view> parts) {
  expect_error([&] { GltfAccessor(parse(writer), 0, "POSITION of mesh 'm'"); }, parts);
}

TEST(GltfAccessor, AllComponentTypes) {
  GltfWriter w;
  w.add_accessor("VEC2", 2, std::vector<std::int8_t>{-128, 127, 0, 64});
  w.add_accessor("VEC4", 4, std::vector<std::uint8_t>{0, 51, 255, 1});
  w.add_accessor("SCALAR", 1, std::vector<std::int16_t>{-32768, 32767});
  w.add_accessor("SCALAR", 1, std::vector<std::uint16_t>{0, 65535, 13107});
  w.add_accessor("SCALAR", 1, std::vector<std::uint32_t>{7, 4294967295u});
  w.add_vec3({1.5f, -2, 3});
  const GltfDocument plain = parse(w);
  EXPECT_EQ(numbers(plain, 0), (std::vector<float>{-128, 127, 0, 64}));
  EXPECT_EQ(numbers(plain, 4), (std::vector<float>{7, 4294967296.0f}));
  EXPECT_EQ(numbers(plain, 5), (std::vector<float>{1.5f, -2, 3}));
  EXPECT_EQ(GltfAccessor(plain, 4, "").index(1), 4294967295u);
  EXPECT_EQ(GltfAccessor(plain, 3, "").index(2), 13107u);
  for (auto& accessor : w.document["accessors"]) accessor["normalized"] = true;
  const GltfDocument normalized = parse(w);
  EXPECT_EQ(numbers(normalized, 0), (std::vector<float>{-1, 1, 0, 64 / 127.0f}));
  EXPECT_EQ(numbers(normalized, 1), (std::vector<float>{0, 0.2f, 1, 1 / 255.0f}));
  EXPECT_EQ(numbers(normalized, 2), (std::vector<float>{-1, 1}));
  EXPECT_EQ(numbers(normalized, 3), (std::vector<float>{0, 1, 0.2f}));
}

TEST(GltfAccessor, StridesAndOffsets) {
  GltfWriter w;
  w.add_view(std::vector<float>{9, 9, 1, 2, 9, 9, 3, 4}, 16);
  w.add("accessors",
        {{"bufferView", 0}, {"byteOffset", 8}, {"componentType", 5126}, {"count", 2}, {"type", "VEC2"}});
  EXPECT_EQ(numbers(parse(w), 0), (std::vector<float>{1, 2, 3, 4}));  // the last stride is not complete
  w.document["accessors"][0]["byteOffset"] = 12;
  refused(w, {"a.gltf: accessor 0 (POSITION of mesh 'm') needs more than the 32 bytes of buffer view 0"});
  w.document["accessors"][0]["byteOffset"] = 0;
  w.document["bufferViews"][0]["byteStride"] = 4;
  refused(w, {"elements of 8 bytes at a stride of 4"});
}

TEST(GltfAccessor, SparseElementsReplaceOthers) {
  GltfWriter w;
  w.add_vec2({1, 2, 3, 4, 5, 6});
  const std::size_t indices = w.add_view(std::vector<std::uint8_t>{0, 2}),
                    values = w.add_view(std::vector<float>{10, 20, 50, 60});
  auto& accessor = w.document["accessors"][0];
  accessor["sparse"] = {{"count", 2},
                        {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                        {"values", {{"bufferView", values}}}};
  EXPECT_EQ(numbers(parse(w), 0), (std::vector<float>{10, 20, 3, 4, 50, 60}));
  accessor.erase("bufferView");  // of zeros
  EXPECT_EQ(numbers(parse(w), 0), (std::vector<float>{10, 20, 0, 0, 50, 60}));
  const GltfWriter good = w;
  accessor["count"] = 2000000000;
  refused(w, {"has 2000000000 elements, but no buffer view"});
  accessor["count"] = 2;
  refused(w, {"replaces an element that it does not have"});
  accessor["count"] = 1;
  refused(w, {"replaces more elements than it has"});
  w = good;
  w.document["accessors"][0]["sparse"]["indices"]["componentType"] = 5126;
  refused(w, {"sparse indices of type 5126"});
  w = good;
  w.document["accessors"][0]["sparse"]["indices"]["byteOffset"] = 1;
  refused(w, {"needs more than the 2 bytes of buffer view"});
  w = good;
  w.document["accessors"][0]["sparse"]["values"]["bufferView"] = 7;
  refused(w, {"refers to buffer view 7, but there are only 3"});
  w = good;
  w.document["accessors"][0]["sparse"]["count"] = 0;
  refused(w, {"replaces no element"});
  w = good;
  w.bytes[24] = 2;  // indices 2, 2
  refused(w, {"do not increase"});
}

TEST(GltfAccessor, WhatDoesNotFitIsRefused) {
  GltfWriter good;
  good.add_vec3({0, 0, 0});
  const auto with = [&](const char* member, nlohmann::json value,
                        std::initializer_list<std::string_view> parts) {
    GltfWriter w = good;
    w.document["accessors"][0][member] = std::move(value);
    refused(w, parts);
  };
  with("count", 0, {"is empty"});
  with("count", 2, {"needs more than the 12 bytes"});
  with("count", 2147483647, {"needs more than the 12 bytes"});
  with("byteOffset", 9007199254740991, {"needs more than the 12 bytes"});
  with("componentType", 5124, {"components of type 5124"});
  with("type", "MAT4", {"is made of matrices"});
  with("type", "VEC5", {"VEC5"});
  with("bufferView", 1, {"refers to buffer view 1, but there are only 1"});
  GltfWriter w = good;
  w.document["bufferViews"][0]["byteOffset"] = 4;
  refused(w, {"buffer view 0 ends at byte 16 of buffer 0, which has 12"});
  w.document["bufferViews"][0]["byteOffset"] = 9007199254740991;
  refused(w, {"buffer view 0 ends at byte"});
  w = good;
  w.document["bufferViews"][0]["buffer"] = 1;
  refused(w, {"buffer view 0 refers to buffer 1, but there are only 1"});
  w = good;
  w.document["bufferViews"][0]["byteStride"] = 3;
  refused(w, {"byteStride"});
  expect_error([&] { GltfAccessor(parse(good), -1, "x"); }, {"x refers to accessor -1"});
}

}  // namespace
}  // namespace twopass
