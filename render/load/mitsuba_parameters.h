// The $parameters of Mitsuba XML: those given with -D and those with a <default>.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>

#include "render/load/load.h"
#include "render/load/mitsuba_document.h"

namespace twopass {

/// "a, b, c": at most twelve of the names, for the last part of an error.
template <class Range>
std::string list_some(const Range& names) {
  std::string list;
  int count = 0;
  for (const std::string& name : names) {
    if (++count > 12) return list + ", ...";
    if (!list.empty()) list += ", ";
    list += name;
  }
  return list.empty() ? "none" : list;
}

class Parameters {
 public:
  /// REQUIRES: `given` outlives this.
  explicit Parameters(const Definitions& given) : given_(given), values_(given) {}

  /// A <default>: counts unless there is a value already.
  void set_default(const std::string& name, const std::string& value);
  /// `text` with every $name replaced; names that begin alike are told apart by the longest that fits. Throws
  /// Error at `node` for a name without a value, listing those that have one.
  std::string replace(const std::string& text, const XmlNode& node);
  /// Throws Error for a -D that the file never mentioned: a misspelt one would otherwise go unnoticed.
  void check_all_used() const;

 private:
  struct Found {
    std::string name, value;
  };
  [[nodiscard]] Found parameter_at(std::string_view text, const XmlNode& node) const;

  const Definitions& given_;
  std::map<std::string, std::string> values_;
  std::set<std::string> seen_;
};

}  // namespace twopass
