// twopass view: a page to walk through a saved solution.
#include <cstdio>
#include <filesystem>

#include "radiosity/solution_file.h"
#include "render/commands/command.h"
#include "render/core/error.h"
#include "render/image/atomic_file.h"
#include "render/image/regular_file.h"
#include "render/web/walk_page.h"

namespace twopass {

namespace {

struct ViewOptions {
  std::string solution, output, title;
};

std::vector<std::byte> display_of(const std::string& solution) {
  if (std::filesystem::path(solution).extension() != ".glb") return display_of_solution(solution);
  const std::string file = read_regular_file(solution);
  const auto bytes = std::as_bytes(std::span(file));
  return {bytes.begin(), bytes.end()};
}

int view(const ViewOptions& options, const GlobalOptions& global) {
  if (const auto extension = std::filesystem::path(options.output).extension();
      extension != ".html" && extension != ".htm")
    throw Error(options.output, "unknown extension of a page", "use one of: .html .htm");
  check_writable(options.output);
  const std::string title =
      options.title.empty() ? std::filesystem::path(options.solution).stem().string() : options.title;
  const std::string page = walk_page(title, display_of(options.solution), options.solution);
  write_atomically(options.output, std::as_bytes(std::span(page)));
  if (global.console().verbosity() != Verbosity::quiet)
    std::printf("wrote %s (%.1f MB); open it in a browser\n", options.output.c_str(),
                static_cast<double>(page.size()) / 1e6);
  return 0;
}

}  // namespace

void add_view_command(CLI::App& program, const GlobalOptions& global, Action& action) {
  auto options = std::make_shared<ViewOptions>();
  CLI::App& command = *program.add_subcommand("view", "A page to walk through a saved solution");
  command.add_option("solution", options->solution, "Solution made with twopass solve: .radiosity or .glb")
      ->required();
  command.add_option("-o,--output", options->output, "Page to write, .html")->required();
  command.add_option("--title", options->title, "Title of the page; default: the file's name");
  command.callback(
      [&action, &global, options] { action = [&global, options] { return view(*options, global); }; });
}

}  // namespace twopass
