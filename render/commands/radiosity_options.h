// The options of the radiosity pass, the same wherever it runs.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "radiosity/options.h"

namespace twopass {

struct RadiosityCommandOptions {
  RadiosityOptions radiosity;  ///< those that need no name
  std::string solver = "auto", form_factors = "auto", subdivision = "auto";

  /// Adds the options to the command; returns them, for commands in which something else replaces them.
  std::vector<CLI::Option*> add_to(CLI::App& command);
  /// The options with the names understood. Throws Error for names that there are not.
  [[nodiscard]] RadiosityOptions settle(std::uint32_t seed) const;
};

}  // namespace twopass
