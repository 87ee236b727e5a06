// What the solvers cost on one balance: a closed room of about 2000 elements, by albedo and by the bound asked
// for.
#include <benchmark/benchmark.h>

#include "radiosity/assemble.h"
#include "radiosity/solvers.h"
#include "radiosity/subdivision.h"
#include "tests/radiosity/test_scenes.h"

namespace twopass {
namespace {

constexpr double albedos[] = {0.5, 0.8, 0.95, 0.999};
constexpr double bounds[] = {1e-2, 1e-4, 1e-8};

// The room with two boxes and a lamp. Everything but the albedo, which plays no part in it.
Balance room_balance() {
  const Scene scene(test::lit_room());
  ElementMesh mesh = divide_surfaces(scene, 2000);
  RadiosityOptions options;
  options.rays_per_element = 512;
  RadiosityStats stats;
  return assemble_balance(scene, mesh, options, FormFactorMethod::rays, CausticParticles(scene), stats);
}

template <class Solve>
void solver(benchmark::State& state, Solve solve) {
  static const Balance room = room_balance();
  Balance balance = room;
  const double albedo = albedos[state.range(0)];
  balance.reflectance.assign(balance.count(), C3f(static_cast<float>(albedo)));
  const StopRule stop{bounds[state.range(1)]};
  SolverResult result;
  for ([[maybe_unused]] auto _ : state) result = solve(balance, stop);
  state.counters["elements"] = balance.count();
  state.counters["albedo"] = albedo;
  state.counters["iterations"] = static_cast<double>(result.iterations);
  state.counters["sweeps"] = static_cast<double>(result.iterations) / balance.count();
  state.counters["bound"] = result.error.bound;
}

SolverResult solve_overshooting(const Balance& balance, const StopRule& stop) {
  return solve_progressive(balance, stop, true);
}
SolverResult solve_shooting(const Balance& balance, const StopRule& stop) {
  return solve_progressive(balance, stop);
}
SolverResult solve_by_elimination(const Balance& balance, const StopRule&) { return solve_lu(balance); }

// All threads count: CPU time of the process.
void all_cases(benchmark::internal::Benchmark* b) {
  b->ArgsProduct({{0, 1, 2, 3}, {0, 1, 2}})->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
}
BENCHMARK_CAPTURE(solver, jacobi, solve_jacobi)->Apply(all_cases);
BENCHMARK_CAPTURE(solver, gauss_seidel, solve_gauss_seidel)->Apply(all_cases);
BENCHMARK_CAPTURE(solver, cg, solve_cg)->Apply(all_cases);
BENCHMARK_CAPTURE(solver, progressive, solve_shooting)->Apply(all_cases);
BENCHMARK_CAPTURE(solver, overshooting, solve_overshooting)->Apply(all_cases);
BENCHMARK_CAPTURE(solver, lu, solve_by_elimination)
    ->Args({0, 0})
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace twopass
