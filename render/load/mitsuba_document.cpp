#include "render/load/mitsuba_document.h"

#include <algorithm>

#include <pugixml.hpp>

#include "render/core/error.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

constexpr int deepest = 100;  // nodes are walked recursively; real scenes nest less than ten deep

/// Line numbers for offsets that only grow: documents are walked in their order.
class LineCounter {
 public:
  explicit LineCounter(std::string_view text) : text_(text) {}
  std::uint32_t line_at(std::ptrdiff_t offset) {
    const std::size_t end =
        std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)), text_.size());
    if (end < counted_) {
      counted_ = 0;
      line_ = 1;
    }
    line_ += static_cast<std::uint32_t>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(counted_),
                                                   text_.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
    counted_ = end;
    return line_;
  }

 private:
  std::string_view text_;
  std::size_t counted_ = 0;
  std::uint32_t line_ = 1;
};

XmlNode copy(const pugi::xml_node& from, const std::shared_ptr<const std::filesystem::path>& file,
             LineCounter& lines, int depth) {
  XmlNode node;
  node.tag = from.name();
  node.file = file;
  node.line = lines.line_at(from.offset_debug());
  if (depth > deepest) throw Error(node.where(), "elements are nested more than 100 deep", "flatten the file");
  for (const pugi::xml_attribute& attribute : from.attributes()) {
    if (node.find(attribute.name()))
      throw Error(node.where(), "attribute '" + std::string(attribute.name()) + "' is given twice",
                  "remove one");
    node.attributes.emplace_back(attribute.name(), attribute.value());
  }
  for (const pugi::xml_node& child : from.children()) {
    if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata)
      throw Error(file->string() + ":" + std::to_string(lines.line_at(child.offset_debug())),
                  "there is text between the elements", "remove it or make it a comment");
    if (child.type() == pugi::node_element) node.children.push_back(copy(child, file, lines, depth + 1));
  }
  return node;
}

}  // namespace

const std::string* XmlNode::find(std::string_view attribute) const {
  for (const auto& [name, value] : attributes)
    if (name == attribute) return &value;
  return nullptr;
}

const std::string& XmlNode::get(std::string_view attribute) const {
  if (const std::string* value = find(attribute)) return *value;
  throw Error(where(), "<" + tag + "> has no attribute '" + std::string(attribute) + "'", "add it");
}

XmlNode read_xml(const std::filesystem::path& path) {
  const std::string text = read_text_file(path);
  LineCounter lines(text);
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(text.data(), text.size());
  if (!result)
    throw Error(path.string() + ":" + std::to_string(lines.line_at(result.offset)),
                "not well-formed XML: " + std::string(result.description()), "correct the file");
  return copy(document.document_element(), std::make_shared<const std::filesystem::path>(path), lines, 0);
}

}  // namespace twopass
