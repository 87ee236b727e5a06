#include "render/load/gltf_uri.h"

#include <algorithm>
#include <array>

#include "render/core/error.h"
#include "render/load/text_file.h"

namespace twopass {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// %20 to a space and so on; a % that starts no number stays (RFC 3986, section 2.1).
std::string percent_decoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int high = i + 2 < text.size() && text[i] == '%' ? hex_digit(text[i + 1]) : -1;
    const int low = high >= 0 ? hex_digit(text[i + 2]) : -1;
    if (low < 0) {
      result += text[i];
    } else {
      result += static_cast<char>(high * 16 + low);
      i += 2;
    }
  }
  return result;
}

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;  // and the alphabet for URLs (RFC 4648, section 5)
  if (c == '/' || c == '_') return 63;
  return -1;
}

std::string base64_decoded(std::string_view text, std::string_view where) {
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string result;
  result.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int available = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int digit = base64_digit(text[i]);
    if (digit < 0)
      throw Error(where, "its data URI is not base64: byte " + std::to_string(i + 1),
                  "export it again, or store the data in a file of its own");
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    available += 6;
    if (available >= 8) {
      available -= 8;
      result += static_cast<char>(bits >> available & 0xffu);
    }
  }
  return result;
}

/// "https" of "https://a/b"; nothing of file names. One letter and a colon is a disk.
std::string_view scheme_of(std::string_view uri) {
  const std::size_t colon = uri.find(':');
  if (colon == std::string_view::npos || colon < 2) return {};
  const std::string_view scheme = uri.substr(0, colon);
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '+' || c == '-' ||
           c == '.';
  };
  return std::ranges::all_of(scheme, is_allowed) ? scheme : std::string_view{};
}

/// The beginning of a name, for errors.
std::string shortened(std::string_view text) {
  constexpr std::size_t most = 80;
  return in_quotes(text.size() <= most ? std::string(text) : std::string(text.substr(0, most)) + "...");
}

}  // namespace

std::optional<std::string> bytes_of_data_uri(std::string_view uri, std::string_view where) {
  if (lower_case(uri.substr(0, 5)) != "data:") return std::nullopt;
  const std::size_t comma = uri.find(',');
  if (comma == std::string_view::npos)
    throw Error(where, "its data URI has no comma before the data", "export it again");
  const std::string_view kind = uri.substr(5, comma - 5), data = uri.substr(comma + 1);
  return kind.ends_with(";base64") ? base64_decoded(data, where) : percent_decoded(data);
}

std::filesystem::path path_of_uri(std::string_view uri, const std::filesystem::path& folder,
                                  std::string_view where) {
  if (const std::string_view scheme = scheme_of(uri); !scheme.empty())
    throw Error(where,
                shortened(uri) + " is not a file: nothing is fetched from '" + std::string(scheme) + ":'",
                "download it, and write its name relative to the scene");
  std::string name = percent_decoded(uri);
  if (name.empty() || name.find('\0') != std::string::npos)
    throw Error(where, shortened(uri) + " is not a file's name", "correct the URI");
  return folder / name;
}

}  // namespace twopass
