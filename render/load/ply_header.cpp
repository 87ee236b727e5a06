#include "render/load/ply_header.h"

#include "render/core/error.h"
#include "render/core/names.h"
#include "render/load/number.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

constexpr Named<PlyType> types[] = {
    {"char", PlyType::int8},       {"uchar", PlyType::uint8},    {"short", PlyType::int16},
    {"ushort", PlyType::uint16},   {"int", PlyType::int32},      {"uint", PlyType::uint32},
    {"float", PlyType::float32},   {"double", PlyType::float64}, {"int8", PlyType::int8},
    {"uint8", PlyType::uint8},     {"int16", PlyType::int16},    {"uint16", PlyType::uint16},
    {"int32", PlyType::int32},     {"uint32", PlyType::uint32},  {"float32", PlyType::float32},
    {"float64", PlyType::float64},
};
constexpr Named<PlyFormat> formats[] = {{"ascii", PlyFormat::ascii},
                                        {"binary_little_endian", PlyFormat::little_endian},
                                        {"binary_big_endian", PlyFormat::big_endian}};

class HeaderReader {
 public:
  HeaderReader(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  PlyHeader run() {
    if (next_line() != "ply") fail("this is no PLY file", "its first line must be 'ply'");
    bool has_format = false;
    for (;;) {
      const std::string_view line = next_line();
      const std::vector<std::string_view> words = split(line, " \t");
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      if (words[0] == "format") {
        if (words.size() != 3 || words[2] != "1.0")
          fail("unknown version of the format", "supported: format ... 1.0");
        header_.format = value_of_name<PlyFormat>(formats, words[1], where(), "format");
        has_format = true;
      } else if (words[0] == "element") {
        read_element(words);
      } else if (words[0] == "property") {
        read_property(words);
      } else {
        fail("unknown keyword " + in_quotes(words[0].substr(0, 40)),
             "a header has: format, element, property, comment, end_header");
      }
    }
    if (!has_format) fail("the header names no format", "add a line like 'format ascii 1.0'");
    header_.size = at_;
    return header_;
  }

 private:
  [[nodiscard]] std::string where() const { return file_ + ":" + std::to_string(header_.lines); }
  [[noreturn]] void fail(const std::string& what, const std::string& hint) const {
    throw Error(where(), what, hint);
  }

  std::string_view next_line() {
    ++header_.lines;
    const std::size_t end = text_.find('\n', at_);
    if (end == std::string_view::npos) fail("the header does not end", "it ends with a line 'end_header'");
    std::string_view line = text_.substr(at_, end - at_);
    at_ = end + 1;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.find('\0') != std::string_view::npos) fail("a zero byte in the header", "the file is damaged");
    return line;
  }

  void read_element(const std::vector<std::string_view>& words) {
    const auto count = words.size() == 3 ? parse_integer(words[2]) : std::nullopt;
    if (!count || *count < 0) fail("an element needs a name and a number", "write 'element vertex 8'");
    header_.elements.push_back({std::string(words[1]), static_cast<std::size_t>(*count), {}});
  }

  void read_property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) fail("a property before the first element", "put it after its element");
    const auto type = [&](std::string_view name) {
      return value_of_name<PlyType>(types, name, where(), "type");
    };
    std::vector<PlyProperty>& properties = header_.elements.back().properties;
    if (words.size() == 5 && words[1] == "list") {
      properties.push_back({std::string(words[4]), type(words[3]), true, type(words[2])});
      if (!is_integer(properties.back().count_type))
        fail("the length of a list is an integer", "use 'property list uchar int vertex_indices'");
    } else if (words.size() == 3) {
      properties.push_back({std::string(words[2]), type(words[1])});
    } else {
      fail("a property needs a type and a name", "write 'property float x' or 'property list uchar int name'");
    }
  }

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
  PlyHeader header_;
};

}  // namespace

std::size_t PlyElement::find(std::string_view property) const {
  std::size_t i = 0;
  while (i < properties.size() && properties[i].name != property) ++i;
  return i;
}

PlyHeader read_ply_header(std::string_view text, const std::string& file) {
  return HeaderReader(text, file).run();
}

}  // namespace twopass
