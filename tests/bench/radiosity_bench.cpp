// What the radiosity pass costs: every form factor method and solver on the Cornell box and the rooms, by
// elements.
#include <benchmark/benchmark.h>

#include "radiosity/solution.h"
#include "render/load/load.h"

namespace twopass {
namespace {

constexpr const char* scenes[] = {"cornell-box", "cove", "hidden", "cornell-box-specular"};

void radiosity(benchmark::State& state, FormFactorMethod method, Solver solver) {
  const std::string file = std::string(TWOPASS_SOURCE_DIR "/scenes/") + scenes[state.range(0)] + "/scene.xml";
  const Scene scene(load_scene(file, {}).scene);
  RadiosityOptions options;
  options.form_factors = method;
  options.solver = solver;
  options.max_elements = static_cast<std::size_t>(state.range(1));
  RadiosityStats stats;
  for ([[maybe_unused]] auto _ : state) stats = solve_radiosity(scene, options).stats();
  state.SetLabel(std::string(scenes[state.range(0)]) + " " + stats.form_factors + " " + stats.solver);
  state.counters["elements"] = static_cast<double>(stats.elements);
  state.counters["rays"] = static_cast<double>(stats.rays);
  state.counters["iterations"] = static_cast<double>(stats.iterations);
  state.counters["bound"] = stats.error_bound;
}

// All threads count: CPU time of the process.
BENCHMARK_CAPTURE(radiosity, defaults, FormFactorMethod::automatic, Solver::automatic)
    ->ArgsProduct({{0, 1, 2, 3}, {0}})
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(radiosity, rays, FormFactorMethod::rays, Solver::gauss_seidel)
    ->ArgsProduct({{0}, {1000, 4000, 16000}})
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(radiosity, point, FormFactorMethod::point, Solver::gauss_seidel)
    ->ArgsProduct({{0}, {500, 1000, 2000}})
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(radiosity, exact, FormFactorMethod::exact, Solver::gauss_seidel)
    ->ArgsProduct({{0}, {500, 1000, 2000}})
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(radiosity, progressive, FormFactorMethod::rays, Solver::progressive)
    ->ArgsProduct({{0}, {1000, 4000, 16000}})
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace twopass
