// stress_agreement COUNT [FIRST]: `path` and `twopass` on COUNT random scenes from seed FIRST on. One line for
// each that disagrees, and a summary; exit code 1 if there is one. Seeds are those of the tests.
#include <cstdio>
#include <cstdlib>

#include "render/stopwatch.h"
#include "tests/stress/random_scene.h"

int main(int count, char** arguments) {
  using namespace twopass::stress;
  if (count < 2) {
    std::fprintf(stderr, "usage: stress_agreement COUNT [FIRST]\n");
    return 2;
  }
  const auto scenes = static_cast<std::uint32_t>(std::strtoul(arguments[1], nullptr, 10));
  const auto first = count > 2 ? static_cast<std::uint32_t>(std::strtoul(arguments[2], nullptr, 10)) : 0u;
  int failures = 0, third_tries = 0;
  double sum = 0.0, weights = 0.0, slowest = 0.0;
  for (std::uint32_t seed = first; seed < first + scenes; ++seed) {
    const Agreement agreement = compare_integrators(seed);
    slowest = std::max(slowest, agreement.path.cpu_seconds + agreement.two_pass.cpu_seconds);
    const double weight = 1.0 / (agreement.noise * agreement.noise + 1e-4);
    sum += weight * agreement.difference;
    weights += weight;
    if (agreement.tries > 2) ++third_tries;
    if (!agreement.holds()) {
      ++failures;
      std::printf("seed %u: twopass / path - 1 = %+.4f +- %.4f %s\n", seed, agreement.difference,
                  agreement.noise, agreement.fault.c_str());
    }
    if ((seed - first + 1) % 100 == 0 || seed + 1 == first + scenes) {
      std::printf(
          "%u scenes, %d disagree, %d took the third try, mean of twopass / path - 1: %+.4f, "
          "slowest %.1f s CPU, %.0f MB\n",
          seed - first + 1, failures, third_tries, sum / weights, slowest,
          static_cast<double>(twopass::peak_memory_bytes()) / 1e6);
      std::fflush(stdout);
    }
  }
  return failures > 0 ? 1 : 0;
}
