// The container of a glTF file: JSON text, in a .glb with a block of bytes behind it.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace twopass {

/// Views into the bytes of the file.
struct GltfChunks {
  std::string_view json;
  std::optional<std::string_view> binary;  ///< the BIN chunk of a .glb
};

/// Splits the bytes of a .gltf or .glb; the first four bytes decide which it is. Throws Error at `file` when a
/// chunk does not fit into the file, or for a version other than 2.
GltfChunks split_gltf(std::string_view bytes, std::string_view file);

}  // namespace twopass
