// Numbers in text, read strictly: the whole token, finite, in the C locale.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace twopass {

/// The number that `token` spells, nothing else in it; nullopt for anything else, for infinities and NaN.
std::optional<double> parse_number(std::string_view token);
/// The same for whole numbers.
std::optional<long long> parse_integer(std::string_view token);

/// The pieces of `text` between separators; empty pieces are dropped.
std::vector<std::string_view> split(std::string_view text, std::string_view separators);

}  // namespace twopass
