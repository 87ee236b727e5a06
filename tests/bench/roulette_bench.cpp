// Where Russian roulette should begin: error and work of `path` by rr_depth. relMSE is that between
// independent renders, so no reference is needed. Usage: roulette_bench [size [renders [scene ...]]].
#include <cstdio>
#include <cstdlib>

#include "render/stopwatch.h"
#include "tests/bench/true_error.h"

namespace twopass::bench {
namespace {

struct Result {
  double relmse, rays, seconds;  // of one render
};

Result measure(const Subject& subject, const Integrator& path, int renders, int samples) {
  std::vector<Film> films;
  Result result{};
  for (int k = 0; k < renders; ++k) {
    films.push_back(subject.film());
    const Stopwatch stopwatch;
    const RenderOutcome outcome =
        subject.render_with(path, films.back(), {samples, 0.0, 0.0}, static_cast<std::uint32_t>(k));
    result.seconds += stopwatch.elapsed().cpu_seconds / renders;
    result.rays += static_cast<double>(outcome.counts.rays + outcome.counts.shadow_rays) / renders;
  }
  const int width = films[0].width(), height = films[0].height();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) {
        double mean = 0.0, squares = 0.0;
        for (const Film& film : films) mean += film.pixel(x, y).mean()[c] / renders;
        for (const Film& film : films) squares += std::pow(film.pixel(x, y).mean()[c] - mean, 2.0);
        result.relmse += squares / (renders - 1) / (mean * mean + relmse_epsilon) / (3.0 * width * height);
      }
  return result;
}

void table(const std::string& name, int size, int renders) {
  constexpr int samples = 64, never = 1 << 30;
  const Subject subject(name, size);
  std::optional<Result> base;
  for (const int rr_depth : {5, 2, 3, 8, 12, never}) {
    const PathTracer path(subject.scene(),
                          {.max_depth = subject.loaded().settings.max_depth, .rr_depth = rr_depth});
    const Result r = measure(subject, path, renders, samples);
    if (!base) base = r;
    std::printf("| %s | %s | %.2e | %.2f | %.2f | %.2f | %.2f |\n", name.c_str(),
                rr_depth == never ? "never" : std::to_string(rr_depth).c_str(), r.relmse,
                r.rays / (samples * size * size), r.relmse / base->relmse,
                base->relmse * base->rays / (r.relmse * r.rays),
                base->relmse * base->seconds / (r.relmse * r.seconds));
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace twopass::bench

int main(int argc, char** argv) {
  using namespace twopass::bench;
  const int size = argc > 1 ? std::atoi(argv[1]) : 32, renders = argc > 2 ? std::atoi(argv[2]) : 16;
  std::printf(
      "| scene | rr_depth | relMSE, 64 spp | rays a path | relMSE to that of 5 | efficiency by rays | by CPU "
      "|\n|---|---|---|---|---|---|---|\n");
  if (argc > 3)
    for (int i = 3; i < argc; ++i) table(argv[i], size, renders);
  else
    for (const char* name : {"cornell-box", "direct", "cove", "hidden", "cornell-box-specular", "materials"})
      table(name, size, renders);
}
