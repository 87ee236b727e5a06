#include "render/load/text_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "render/core/error.h"

namespace twopass {

std::string read_text_file(const std::filesystem::path& path) {
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (status.type() == std::filesystem::file_type::not_found)
    throw Error(path.string(), "there is no such file", "check the name");
  if (status.type() == std::filesystem::file_type::directory)
    throw Error(path.string(), "this is a folder", "name a file in it");
  // Pipes and devices could block or never end.
  if (code || status.type() != std::filesystem::file_type::regular)
    throw Error(path.string(), "this is not a regular file", "name a file");

  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    throw Error(path.string(), std::string("cannot be opened: ") + std::strerror(errno),
                "check its permissions");
  std::string text(std::filesystem::file_size(path), '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad() || static_cast<std::size_t>(stream.gcount()) != text.size())
    throw Error(path.string(), "cannot be read to its end", "check the disk");
  return text;
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  return text.starts_with(mark) ? text.substr(mark.size()) : text;
}

std::string in_quotes(std::string_view text) { return std::string("'").append(text).append("'"); }

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

}  // namespace twopass
