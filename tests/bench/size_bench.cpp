// How the radiosity pass grows with the scene: a room of 1e4 to 4e6 triangles, elements in proportion or fixed.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include "radiosity/solution.h"
#include "tests/support/crowded_room.h"

namespace twopass {
namespace {

void size(benchmark::State& state, Solver solver) {
  const Scene scene(test::crowded_room(static_cast<std::size_t>(state.range(0))));
  RadiosityOptions options;
  options.solver = solver;
  options.max_elements = static_cast<std::size_t>(state.range(1));
  // Enough for gathering: what the solvers make of a percent is another matter.
  if (solver == Solver::stochastic) options.rays_per_element = 64;
  if (solver == Solver::hierarchical) options.relative_error = 0.1;
  RadiosityStats stats;
  for ([[maybe_unused]] auto _ : state) stats = solve_radiosity(scene, options).stats();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.SetLabel(stats.form_factors + " " + stats.solver);
  state.counters["elements"] = static_cast<double>(stats.elements);
  state.counters["rays"] = static_cast<double>(stats.rays);
  state.counters["links"] = static_cast<double>(stats.links);
  state.counters["bytes/element"] =
      static_cast<double>(stats.memory_bytes) / static_cast<double>(std::max<std::size_t>(1, stats.elements));
  state.counters["peak MB of all so far"] = static_cast<double>(usage.ru_maxrss) / 1024.0;
}

// All threads count: CPU time of the process.
BENCHMARK_CAPTURE(size, defaults, Solver::automatic)
    ->ArgsProduct({{10'000, 100'000, 1'000'000, 4'000'000}, {0}})
    ->Iterations(1)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

BENCHMARK_CAPTURE(size, stochastic, Solver::stochastic)
    ->ArgsProduct({{100'000, 1'000'000, 4'000'000}, {0}})
    ->Iterations(1)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(size, hierarchical, Solver::hierarchical)
    ->ArgsProduct({{10'000}, {1'000, 10'000, 100'000}})
    ->Iterations(1)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace twopass
