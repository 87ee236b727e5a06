// One XML file as a tree of plain nodes with line numbers. The only place that knows pugixml; knows nothing of
// Mitsuba.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace twopass {

struct XmlNode {
  std::string tag;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<XmlNode> children;
  std::shared_ptr<const std::filesystem::path> file;
  std::uint32_t line = 0;

  /// "file:line", for errors.
  [[nodiscard]] std::string where() const { return file->string() + ":" + std::to_string(line); }
  /// The value of an attribute, or nullptr.
  [[nodiscard]] const std::string* find(std::string_view attribute) const;
  /// The value of an attribute. Throws Error naming the attribute when it is missing.
  [[nodiscard]] const std::string& get(std::string_view attribute) const;
};

/// Reads a file; returns its root element. Throws Error with file:line when it is not well-formed, has text
/// between elements or is nested more than 100 deep.
XmlNode read_xml(const std::filesystem::path& path);

}  // namespace twopass
