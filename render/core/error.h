// The one exception type of the program. Thrown where the fact is known, caught once in main.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace twopass {

/// An error that ends the command with exit code 1 and the message `where: what; what to do`.
class Error : public std::runtime_error {
 public:
  /// `where` is a file, file:line or option; `what` the fact; `remedy` what the user can do about it.
  Error(std::string_view where, std::string_view what, std::string_view remedy)
      : std::runtime_error(std::string(where) + ": " + std::string(what) + "; " + std::string(remedy)) {}
};

/// "a, b, c": the names that would have worked, for the last part of an error.
std::string join_names(std::span<const std::string_view> names);

}  // namespace twopass
