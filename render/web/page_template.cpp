#include "render/web/page_template.h"

#include <algorithm>
#include <stdexcept>

namespace twopass {

std::string escape_html(std::string_view text) {
  std::string escaped;
  for (const char c : text) switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  return escaped;
}

std::string fill_in(std::string_view page,
                    const std::vector<std::pair<std::string_view, std::string>>& values) {
  std::string filled;
  for (;;) {
    const std::size_t begin = page.find("{{"), end = page.find("}}", begin);
    filled += page.substr(0, begin);
    if (begin == page.npos || end == page.npos) return filled;
    const std::string_view name = page.substr(begin + 2, end - begin - 2);
    const auto value =
        std::find_if(values.begin(), values.end(), [&](const auto& v) { return v.first == name; });
    if (value == values.end()) throw std::logic_error("no value for {{" + std::string(name) + "}}");
    filled += value->second;
    page.remove_prefix(end + 2);
  }
}

}  // namespace twopass
