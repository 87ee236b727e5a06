// The header of a PLY file: which elements there are, and what each consists of.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace twopass {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
constexpr bool is_integer(PlyType type) { return type < PlyType::float32; }
/// In bytes.
constexpr std::size_t size_of(PlyType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

struct PlyProperty {
  std::string name;
  PlyType type;
  bool is_list = false;
  PlyType count_type = PlyType::uint8;  ///< of lists
};

struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
  /// Index of a property; properties.size() if there is none.
  [[nodiscard]] std::size_t find(std::string_view property) const;
  [[nodiscard]] bool has(std::string_view property) const { return find(property) < properties.size(); }
};

enum class PlyFormat { ascii, little_endian, big_endian };

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::size_t size = 0;   ///< in bytes: where the data begins
  std::size_t lines = 0;  ///< how many it has
};

/// Throws Error with `file`:line.
PlyHeader read_ply_header(std::string_view text, const std::string& file);

}  // namespace twopass
