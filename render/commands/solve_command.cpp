// twopass solve: the radiosity pass alone, to be kept or to be looked at.
#include <algorithm>
#include <cstdio>

#include "radiosity/display_mesh.h"
#include "radiosity/grouped_light.h"
#include "radiosity/mesh_files.h"
#include "radiosity/solution_file.h"
#include "render/commands/command.h"
#include "render/commands/display_options.h"
#include "render/commands/radiosity_options.h"
#include "render/commands/scene_options.h"
#include "render/core/parallel.h"
#include "render/image/atomic_file.h"
#include "render/layers.h"
#include "render/statistics.h"

namespace twopass {

namespace {

struct SolveOptions {
  SceneOptions scene;
  std::vector<std::string> outputs;
  std::string stats_file;
  std::optional<std::uint32_t> seed;
  RadiosityCommandOptions radiosity;
  std::string config, working_space;
  bool light_groups = false;
};

enum class SolutionFormat { solution, gltf, ply };

constexpr Named<SolutionFormat> format_extensions[] = {
    {".radiosity", SolutionFormat::solution},
    {".glb", SolutionFormat::gltf},
    {".ply", SolutionFormat::ply},
};

SolutionFormat format_of(const std::string& path) {
  return value_of_name<SolutionFormat>(format_extensions, std::filesystem::path(path).extension().string(),
                                       path, "extension of a solution");
}

void write_solution(const std::string& path, const Scene& scene, const Solution& solution,
                    const ColorMatrix& to_rec709, const GroupedIrradiance& groups,
                    std::optional<DisplayMesh>& mesh) {
  const SolutionFormat format = format_of(path);
  if (format == SolutionFormat::solution) return save_solution(path, scene, solution, to_rec709, groups);
  if (!mesh) mesh = display_mesh(scene, solution, to_rec709);
  if (format == SolutionFormat::ply)
    write_ply(path, *mesh);
  else
    write_glb(path, *mesh, scene);
}

void report(const SolveOptions& options, const RenderStatistics& s, const Console& console) {
  if (console.verbosity() == Verbosity::quiet) return;
  const RadiosityStats& stats = *s.radiosity;
  std::printf("%-13s %s\n", "solver", stats.solver.c_str());
  std::printf("%-13s %s\n", "form factors", stats.form_factors.c_str());
  std::printf("%-13s %zu\n", "elements", stats.elements);
  std::printf("%-13s %zu\n", "links", stats.links);
  std::printf("%-13s %zu\n", "iterations", stats.iterations);
  std::printf("%-13s %llu\n", "rays", static_cast<unsigned long long>(stats.rays));
  std::printf("%-13s %.3g\n", "residual", stats.residual);
  std::printf("%-13s %.3g\n", "error bound", stats.error_bound);
  if (stats.max_reflections >= 0) std::printf("%-13s %d at most\n", "reflections", stats.max_reflections);
  std::printf("%-13s %.2f s (%.2f s CPU)\n", "time", s.radiosity_time.seconds, s.radiosity_time.cpu_seconds);
  std::printf("%-13s %.1f MB\n", "memory", static_cast<double>(stats.memory_bytes) / 1e6);
  for (const std::string& output : options.outputs) std::printf("wrote %s\n", output.c_str());
}

int solve(const SolveOptions& options, const GlobalOptions& global) {
  const Console console = global.console();
  const Stopwatch total;
  RenderStatistics s;
  s.is_render = false;
  // What can go wrong with the outputs goes wrong before any work is done.
  const auto is_solution = [](const std::string& path) { return format_of(path) == SolutionFormat::solution; };
  if (options.light_groups && std::ranges::none_of(options.outputs, is_solution))
    throw Error("--light-groups", "only .radiosity files keep light groups", "add -o FILE.radiosity");
  for (const std::string& output : options.outputs) {
    format_of(output);
    check_writable(output);
  }
  if (!options.stats_file.empty()) check_writable(options.stats_file);
  const WorkingSpace space = find_working_space(options.working_space, options.config);
  const ThreadLimit limit(global.threads);

  Stopwatch stopwatch;
  LoadedScene loaded = options.scene.load(console, SceneOptions::Additions::light, options.config);
  if (!space.is_rec709()) put_in_primaries(loaded.scene, space.from_rec709);
  s.seed = options.seed.value_or(loaded.settings.seed.value_or(0));
  const RadiosityOptions radiosity = options.radiosity.settle(s.seed);
  s.load = stopwatch.elapsed();

  stopwatch = Stopwatch();
  const Scene scene(std::move(loaded.scene));
  s.build = stopwatch.elapsed();

  stopwatch = Stopwatch();
  const Solution solution = solve_radiosity(scene, radiosity);
  GroupedIrradiance groups;
  if (options.light_groups) groups = solve_by_group(scene, light_groups_of(scene), solution, radiosity);
  s.radiosity_time = stopwatch.elapsed();
  s.radiosity = solution.stats();
  for (const std::string& note : solution.stats().notes) console.note(note);

  stopwatch = Stopwatch();
  std::optional<DisplayMesh> mesh;
  for (const std::string& output : options.outputs)
    write_solution(output, scene, solution, space.to_rec709, groups, mesh);
  s.write = stopwatch.elapsed();
  s.total = total.elapsed();

  s.scene_file = options.scene.file;
  s.count(scene);
  s.threads = limit.threads();
  if (!options.stats_file.empty()) write_statistics(options.stats_file, s);
  report(options, s, console);
  return 0;
}

}  // namespace

void add_solve_command(CLI::App& program, const GlobalOptions& global, Action& action) {
  auto options = std::make_shared<SolveOptions>();
  CLI::App& command = *program.add_subcommand("solve", "The radiosity pass alone, to keep or to look at");
  options->scene.add_to(command);
  options->scene.add_sky_to(command);
  command
      .add_option("-o,--output", options->outputs,
                  "File to write (repeatable): .radiosity for render --solution; .glb, .ply to look at")
      ->required()
      ->allow_extra_args(false);
  options->radiosity.add_to(command);
  add_ocio_option(command, options->config);
  add_working_space_option(command, options->working_space);
  command
      .add_option("--max-reflections", options->radiosity.radiosity.max_reflections,
                  "Most diffuse reflections of the indirect light, for renders of limited depth; -1: all")
      ->check(CLI::Range(-1, 1 << 30));
  command.add_flag("--light-groups", options->light_groups,
                   "Keep what each light group makes of it too, for render --light-groups");
  command.add_option("--seed", options->seed, "Seed of all random numbers");
  command.add_option("--stats", options->stats_file, "Write statistics as JSON");
  command.callback(
      [options, &global, &action] { action = [options, &global] { return solve(*options, global); }; });
}

}  // namespace twopass
