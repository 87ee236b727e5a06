// HTML pages from templates with gaps to fill in.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace twopass {

/// The text with &, <, >, " and ' as HTML writes them.
std::string escape_html(std::string_view text);

/// The template with every {{name}} replaced by the value of that name; values are not looked through again. A
/// name without value is a mistake of the program's: throws std::logic_error.
std::string fill_in(std::string_view page, const std::vector<std::pair<std::string_view, std::string>>& values);

}  // namespace twopass
