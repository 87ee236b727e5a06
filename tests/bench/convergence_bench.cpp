// How the error falls with the number of samples: relMSE of `path` by sampler, and the slope of its logarithm.
// The variance of a pixel is that between independent renders, so no reference is needed. Beside it the CPU
// time of a path and of a pair of numbers alone. Usage: convergence_bench [scene.xml [size [renders]]].
#include <cstdio>
#include <cstdlib>

#include "render/stopwatch.h"
#include "tests/bench/true_error.h"

namespace twopass {
namespace {

constexpr int counts[] = {1, 4, 16, 64, 256};

struct Pictures {
  const Integrator& path;
  const Camera& camera;
  int size, renders;
};

struct Result {
  double relmse, blurred_relmse, microseconds_a_path;
};

// What the eye makes of a picture at arm's length: a Gaussian of 1.5 pixels' standard deviation.
Image blurred(const Image& image) {
  constexpr int radius = 4;
  constexpr double deviation = 1.5;
  const auto pass = [&](const Image& from, int dx, int dy) {
    Image to(from.width, from.height, from.channels);
    for (int y = 0; y < from.height; ++y)
      for (int x = 0; x < from.width; ++x)
        for (int c = 0; c < 3; ++c) {
          double sum = 0.0, weights = 0.0;
          for (int k = -radius; k <= radius; ++k) {
            const int i = x + k * dx, j = y + k * dy;
            if (i < 0 || j < 0 || i >= from.width || j >= from.height) continue;
            const double weight = std::exp(-0.5 * k * k / (deviation * deviation));
            sum += weight * from.at(i, j, c);
            weights += weight;
          }
          to.at(x, y, c) = static_cast<float>(sum / weights);
        }
    return to;
  };
  return pass(pass(image, 1, 0), 0, 1);
}

Result measure(const Pictures& pictures, SamplerKind kind, int samples) {
  std::vector<Image> images;
  const Stopwatch stopwatch;
  for (int k = 0; k < pictures.renders; ++k) {
    Film film(pictures.size, pictures.size);
    // A box filter: it adds least to what the light itself varies.
    render_image({pictures.path,
                  pictures.camera,
                  box_filter(),
                  {samples, 0.0, 0.0},
                  static_cast<std::uint32_t>(k),
                  kind,
                  {}},
                 film);
    images.push_back(film.resolve());
  }
  const double paths = static_cast<double>(pictures.size) * pictures.size * pictures.renders * samples;
  const double cpu = stopwatch.elapsed().cpu_seconds;
  std::vector<Image> seen;
  for (const Image& image : images) seen.push_back(blurred(image));
  return {bench::relmse_between(images), bench::relmse_between(seen), 1e6 * cpu / paths};
}

// Least squares through the logarithms.
double slope(std::span<const double> relmse) {
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  const auto n = static_cast<double>(relmse.size());
  for (std::size_t i = 0; i < relmse.size(); ++i) {
    const double x = std::log(counts[i]), y = std::log(relmse[i]);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

double nanoseconds_a_pair(SamplerKind kind) {
  constexpr std::uint32_t samples = 1 << 20, pairs = 8;
  float sum = 0.0f;
  const Stopwatch stopwatch;
  for (std::uint32_t i = 0; i < samples; ++i) {
    Sampler sampler(1, i / 64, i % 64, kind, 64);
    for (std::uint32_t k = 0; k < pairs; ++k) {
      const V2f u = sampler.next_2d();
      sum += u.x + u.y;
    }
  }
  const double seconds = stopwatch.elapsed().cpu_seconds;
  return sum > 0.0f ? 1e9 * seconds / (samples * pairs) : 0.0;
}

}  // namespace
}  // namespace twopass

int main(int argc, char** argv) {
  using namespace twopass;
  const LoadedScene loaded =
      load_scene(argc > 1 ? argv[1] : TWOPASS_SOURCE_DIR "/scenes/cornell-box/scene.xml", {});
  const int size = argc > 2 ? std::atoi(argv[2]) : 48, renders = argc > 3 ? std::atoi(argv[3]) : 8;
  const Scene scene(loaded.scene);
  const Camera camera(*loaded.scene.camera, size, size);
  const PathTracer path(scene, {.max_depth = loaded.settings.max_depth});
  std::printf("%-12s", "sampler");
  for (const int n : counts) std::printf(" %9d", n);
  std::printf("     slope   us/path   ns/pair\n");
  for (const auto& sampler : sampler_names) {
    std::vector<double> relmse, blurred_relmse;
    double microseconds = 0.0;
    for (const int n : counts) {
      const Result result = measure({path, camera, size, renders}, sampler.value, n);
      relmse.push_back(result.relmse);
      blurred_relmse.push_back(result.blurred_relmse);
      microseconds = result.microseconds_a_path;
    }
    std::printf("%-12s", std::string(sampler.name).c_str());
    for (const double value : relmse) std::printf(" %9.2e", value);
    std::printf(" %9.3f %9.3f %9.1f\n%-12s", slope(relmse), microseconds, nanoseconds_a_pair(sampler.value),
                "  blurred");
    for (const double value : blurred_relmse) std::printf(" %9.2e", value);
    std::printf(" %9.3f\n", slope(blurred_relmse));
  }
}
