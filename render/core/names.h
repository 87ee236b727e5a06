// One table of names for each set of choices: it serves the command line, the errors and the documentation.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/core/error.h"

namespace twopass {

template <class T>
struct Named {
  std::string_view name;
  T value;
};

/// The value called `name`. Throws Error at `where`, listing the known names, when there is none.
template <class T>
T value_of_name(std::span<const Named<T>> table, std::string_view name, std::string_view where,
                std::string_view kind) {
  std::vector<std::string_view> known;
  for (const Named<T>& entry : table) {
    if (entry.name == name) return entry.value;
    known.push_back(entry.name);
  }
  throw Error(where, "unknown " + std::string(kind) + " '" + std::string(name) + "'",
              "use one of: " + join_names(known));
}

/// The first name of `value` in the table. REQUIRES: the table holds the value.
template <class T>
std::string_view name_of_value(std::span<const Named<T>> table, const T& value) {
  for (const Named<T>& entry : table)
    if (entry.value == value) return entry.name;
  return "?";
}

}  // namespace twopass
