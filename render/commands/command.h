// What every command shares. A command registers its options and, when chosen, becomes the action to run.
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "render/console.h"

namespace twopass {

/// Options that every command takes.
struct GlobalOptions {
  bool quiet = false;
  bool verbose = false;
  int threads = 0;  ///< 0: all cores

  [[nodiscard]] Console console() const {
    return Console(quiet ? Verbosity::quiet : verbose ? Verbosity::verbose : Verbosity::normal);
  }
};

/// Runs the chosen command; the result is the exit code. Throws Error.
using Action = std::function<int()>;

// Each adds its command to the program; parsing then fills in `action` if the command was chosen. The
// references must outlive the parsing and the action.
void add_render_command(CLI::App& program, const GlobalOptions& global, Action& action);
void add_solve_command(CLI::App& program, const GlobalOptions& global, Action& action);
void add_compare_command(CLI::App& program, const GlobalOptions& global, Action& action);
void add_bench_command(CLI::App& program, const GlobalOptions& global, Action& action);
void add_form_factors_command(CLI::App& program, const GlobalOptions& global, Action& action);
void add_info_command(CLI::App& program, const GlobalOptions& global, Action& action);
void add_view_command(CLI::App& program, const GlobalOptions& global, Action& action);
void add_merge_command(CLI::App& program, const GlobalOptions& global, Action& action);

}  // namespace twopass
