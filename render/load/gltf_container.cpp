#include "render/load/gltf_container.h"

#include <cstdint>

#include "render/core/error.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

constexpr std::uint32_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;  // "JSON" and "BIN\0"

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

}  // namespace

GltfChunks split_gltf(std::string_view bytes, std::string_view file) {
  if (!bytes.starts_with("glTF")) return {without_byte_order_mark(bytes), std::nullopt};
  const auto fail = [&](const std::string& what) { throw Error(file, what, "export or download it again"); };
  if (bytes.size() < 12) fail("the file ends within the header of a .glb");
  if (const std::uint32_t version = little_endian(bytes, 4); version != 2)
    throw Error(file, "version " + std::to_string(version) + " of the .glb container is not supported",
                "convert it to glTF 2.0");
  const std::uint32_t length = little_endian(bytes, 8);
  if (length > bytes.size())
    fail("the header says " + std::to_string(length) + " bytes, but the file has " +
         std::to_string(bytes.size()));
  bytes = bytes.substr(0, length);
  GltfChunks chunks;
  std::size_t number = 0;
  for (std::size_t at = 12; at + 8 <= bytes.size(); ++number) {
    const std::uint32_t size = little_endian(bytes, at), type = little_endian(bytes, at + 4);
    at += 8;
    if (size > bytes.size() - at)
      fail("chunk " + std::to_string(number) + " says " + std::to_string(size) + " bytes, but only " +
           std::to_string(bytes.size() - at) + " are left");
    const std::string_view chunk = bytes.substr(at, size);
    if (number == 0) {
      if (type != json_chunk) fail("the first chunk of the .glb is not JSON");
      chunks.json = chunk;
    }
    if (number == 1 && type == binary_chunk) chunks.binary = chunk;  // of other types readers know nothing
    at += size;
  }
  if (number == 0) fail("the .glb has no chunks");
  return chunks;
}

}  // namespace twopass
