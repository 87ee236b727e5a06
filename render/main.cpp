// The program: parses the command line, runs one command, prints the one error, sets the exit code.
#include <csignal>
#include <cstdio>
#include <new>

#include "render/commands/command.h"
#include "render/core/error.h"
#include "render/core/interrupt.h"
#include "render/version.h"

namespace {

constexpr int exit_error = 1, exit_usage = 2;

void on_interrupt(int signal) {
  // A second Ctrl-C means it: give the signal its usual effect again.
  twopass::interrupt_signal() = signal;
  twopass::interrupt_requested() = true;
  std::signal(signal, SIG_DFL);
}

void on_write_request(int) { twopass::write_requested() = true; }

// The names that would have worked in place of one that nobody knows.
void print_known_names(const CLI::App& program) {
  const auto chosen = program.get_subcommands();
  std::string names;
  if (chosen.empty())
    for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; }))
      names += ' ' + command->get_name();
  else
    for (const CLI::Option* option : chosen.front()->get_options())
      if (!option->get_lnames().empty()) names += " --" + option->get_lnames().front();
  std::fprintf(stderr, "%s:%s\n", chosen.empty() ? "commands" : "its options", names.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program("Radiosity and path tracing, in two passes.", "twopass");
  program.set_version_flag("--version", std::string("twopass ") + twopass::program_version);
  program.require_subcommand(1);
  program.fallthrough();
  twopass::GlobalOptions global;
  auto* quiet = program.add_flag("--quiet", global.quiet, "Say nothing but errors");
  program.add_flag("--verbose", global.verbose, "Say more")->excludes(quiet);
  program.add_option("--threads", global.threads, "Number of threads; 0: all cores")
      ->check(CLI::Range(0, 4096));
  twopass::Action action;
  twopass::add_render_command(program, global, action);
  twopass::add_solve_command(program, global, action);
  twopass::add_form_factors_command(program, global, action);
  twopass::add_compare_command(program, global, action);
  twopass::add_bench_command(program, global, action);
  twopass::add_info_command(program, global, action);
  twopass::add_view_command(program, global, action);
  twopass::add_merge_command(program, global, action);

  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& wish) {  // --help, --version
    return program.exit(wish);
  } catch (const CLI::ExtrasError& error) {
    program.exit(error);
    print_known_names(program);
    return exit_usage;
  } catch (const CLI::ParseError& error) {
    program.exit(error);
    return exit_usage;
  }

  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  std::signal(SIGUSR1, on_write_request);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that grows too large is an error like a full disk
  try {
    return action();
  } catch (const twopass::Interrupted&) {
    std::fprintf(stderr, "interrupted before there was anything to write\n");
    return twopass::exit_interrupted();
  } catch (const twopass::Error& error) {
    std::fprintf(stderr, "%s\n", twopass::printable(error.what()).c_str());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "twopass: out of memory; use a smaller picture, fewer elements or a larger machine\n");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "twopass: unexpected failure (%s); please report it with the command line\n",
                 error.what());
  }
  return exit_error;
}
