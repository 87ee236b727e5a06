// Renders to a goal of noise: what they estimate their error to be against what it is, and their error against
// that of as many samples divided equally (gain: squared error of those over that of the shared ones). Usage:
// adaptive_bench [size [runs [scene ...]]].
#include <cstdio>

#include "render/stopwatch.h"
#include "tests/bench/true_error.h"

namespace twopass::bench {
namespace {

constexpr double goals[] = {0.2, 0.1, 0.05};

// CPU seconds of one call.
template <class Call>
double seconds_of(const Call& call) {
  const Stopwatch stopwatch;
  call();
  return stopwatch.elapsed().cpu_seconds;
}

// Of several runs: mean squares of errors, means of the rest.
struct Row {
  double samples = 0.0, early = 0.0, estimated = 0.0, truth = 0.0, uniform = 0.0, seconds = 0.0,
         uniform_seconds = 0.0;
};

void measure(const std::string& name, int size, int runs) {
  const Subject subject(name, size);
  const Reference reference = make_reference(subject, 8192);
  for (const double goal : goals) {
    Row row;
    for (int run = 0; run < runs; ++run) {
      const auto seed = static_cast<std::uint32_t>(run);
      Film film = subject.film();
      row.seconds += seconds_of([&] {
        row.early += subject.render(film, {0, 0.0, goal}, seed).pixels_stopped_early;
      });
      const double spp = static_cast<double>(film.samples()) / size / size;
      row.samples += spp;
      row.estimated += film.relative_error() * film.relative_error();
      row.truth += true_relmse(film, reference);
      Film uniform = subject.film();
      row.uniform_seconds += seconds_of([&] {
        subject.render(uniform, {std::max(1, static_cast<int>(std::lround(spp))), 0.0, 0.0}, seed);
      });
      row.uniform += true_relmse(uniform, reference);
    }
    const double n = runs;
    std::printf("| %s | %g | %.0f | %.0f %% | %.4f | %.4f | %.4f | %.2f | %.2f |\n", name.c_str(), goal,
                row.samples / n, 100 * row.early / n, std::sqrt(row.estimated / n), std::sqrt(row.truth / n),
                std::sqrt(row.uniform / n), row.uniform / row.truth,
                row.uniform * row.uniform_seconds / (row.truth * row.seconds));
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace twopass::bench

int main(int argc, char** argv) {
  using namespace twopass::bench;
  const Arguments arguments(argc, argv,
                            {32, 4, {"cornell-box", "cornell-box-specular", "materials", "direct", "cove"}});
  std::printf(
      "| scene | goal | samples a pixel | stopped early | estimated error | true error | true, uniform | gain "
      "by samples | by CPU |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& scene : arguments.scenes) measure(scene, arguments.size, arguments.runs);
}
