#include "render/load/number.h"

#include <charconv>
#include <cmath>

namespace twopass {
namespace {

template <class T>
std::optional<T> parse_whole(std::string_view token) {
  if (token.starts_with('+') && !token.starts_with("+-")) token.remove_prefix(1);  // from_chars knows no plus
  T value{};
  const auto [end, code] = std::from_chars(token.data(), token.data() + token.size(), value);
  if (code != std::errc() || end != token.data() + token.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> parse_number(std::string_view token) {
  const std::optional<double> value = parse_whole<double>(token);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<long long> parse_integer(std::string_view token) { return parse_whole<long long>(token); }

std::vector<std::string_view> split(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> pieces;
  while (true) {
    const std::size_t begin = text.find_first_not_of(separators);
    if (begin == std::string_view::npos) return pieces;
    text.remove_prefix(begin);
    const std::size_t size = std::min(text.find_first_of(separators), text.size());
    pieces.push_back(text.substr(0, size));
    text.remove_prefix(size);
  }
}

}  // namespace twopass
