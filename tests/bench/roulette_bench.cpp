// Where Russian roulette should begin: error and work of `path` by rr_depth. relMSE is that between
// independent renders, so no reference is needed. Usage: roulette_bench [size [renders [scene ...]]].
#include <cstdio>

#include "render/stopwatch.h"
#include "tests/bench/true_error.h"

namespace twopass::bench {
namespace {

struct Result {
  double relmse, rays, seconds;  // of one render
};

Result measure(const Subject& subject, const Integrator& path, int renders, int samples) {
  std::vector<Image> images;
  Result result{};
  for (int k = 0; k < renders; ++k) {
    Film film = subject.film();
    const Stopwatch stopwatch;
    const RenderOutcome outcome =
        subject.render_with(path, film, {samples, 0.0, 0.0}, static_cast<std::uint32_t>(k));
    result.seconds += stopwatch.elapsed().cpu_seconds / renders;
    result.rays += static_cast<double>(outcome.counts.rays + outcome.counts.shadow_rays) / renders;
    images.push_back(film.resolve());
  }
  result.relmse = relmse_between(images);
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
  const Arguments arguments(
      argc, argv, {32, 16, {"cornell-box", "direct", "cove", "hidden", "cornell-box-specular", "materials"}});
  std::printf(
      "| scene | rr_depth | relMSE, 64 spp | rays a path | relMSE to that of 5 | efficiency by rays | by CPU "
      "|\n|---|---|---|---|---|---|---|\n");
  for (const std::string& scene : arguments.scenes) table(scene, arguments.size, arguments.runs);
}
