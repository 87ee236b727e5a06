#include "render/load/gltf_container.h"

#include "tests/load/gltf_writer.h"
#include "tests/load/load_fixture.h"

namespace twopass {
namespace {

std::string header(std::size_t length, std::size_t version = 2) {
  return "glTF" + GltfWriter::number(version) + GltfWriter::number(length);
}
std::string chunk(const std::string& type, const std::string& data) {
  return GltfWriter::number(data.size()) + type + data;
}
const std::string bin("BIN\0", 4);

TEST(GltfContainer, TextIsTakenAsItIs) {
  const GltfChunks chunks = split_gltf("\xEF\xBB\xBF{}", "a.gltf");
  EXPECT_EQ(chunks.json, "{}");
  EXPECT_FALSE(chunks.binary);
}

TEST(GltfContainer, ChunksOfABinaryFile) {
  const std::string body = chunk("JSON", "{}  ") + chunk(bin, "abcd") + chunk("MORE", "");
  const std::string file = header(12 + body.size()) + body + "trailing";
  const GltfChunks chunks = split_gltf(file, "a.glb");
  EXPECT_EQ(chunks.json, "{}  ");
  EXPECT_EQ(chunks.binary, "abcd");
  const std::string other = chunk("JSON", "{}") + chunk("MORE", "abcd");
  EXPECT_FALSE(split_gltf(header(12 + other.size()) + other, "a.glb").binary);
}

TEST(GltfContainer, ChunksThatDoNotFitAreRefused) {
  const auto refused = [](const std::string& bytes, std::initializer_list<std::string_view> parts) {
    expect_error([&] { split_gltf(bytes, "a.glb"); }, parts);
  };
  refused("glTF", {"a.glb: the file ends within the header"});
  refused(header(12), {"no chunks"});
  refused(header(12, 1), {"version 1", "convert it to glTF 2.0"});
  refused(header(100) + chunk("JSON", "{}"), {"header says 100 bytes, but the file has 22"});
  const std::string text = chunk("JSON", "{}  ");
  // The last 8 bytes of this chunk would lie beyond the file.
  const std::string long_chunk = GltfWriter::number(12) + bin + "abcd";
  refused(header(12 + text.size() + long_chunk.size()) + text + long_chunk,
          {"chunk 1 says 12 bytes, but only 4 are left"});
  refused(header(12 + text.size()) + GltfWriter::number(0xffffffff) + "JSON{}  ", {"chunk 0 says 4294967295"});
  const std::string first_binary = chunk(bin, "abcd");
  refused(header(12 + first_binary.size()) + first_binary, {"the first chunk of the .glb is not JSON"});
}

}  // namespace
}  // namespace twopass
