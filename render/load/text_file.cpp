#include "render/load/text_file.h"

#include "render/core/error.h"
#include "render/image/regular_file.h"

namespace twopass {

std::string read_text_file(const std::filesystem::path& path) { return read_regular_file(path); }

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

std::string_view utf8_text(std::string_view text, std::string_view where) {
  if (text.starts_with("\xFE\xFF") || text.starts_with("\xFF\xFE"))
    throw Error(where, "this is text in UTF-16", "save it in UTF-8");
  return without_byte_order_mark(text);
}

std::string in_quotes(std::string_view text) { return std::string("'").append(text).append("'"); }

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

}  // namespace twopass
