// Path tracing, and what the radiosity solution adds to it: relMSE times samples, CPU time and rays a sample,
// and the CPU seconds to a relMSE of 1e-3 at 512x512, radiosity and guide included. The variance of a pixel is
// that between independent renders; beside it the square of the difference of the means from the path tracer's,
// less what noise explains: the bias. The renders take turns, so that whatever else the machine does hits all
// alike. Usage: unbiased_bench [size [samples [renders [scene.xml ...]]]]
#include <cstdio>
#include <cstdlib>

#include "integrators/make_integrator.h"
#include "radiosity/guide.h"
#include "render/image/compare.h"
#include "render/load/load.h"
#include "render/render_image.h"
#include "render/stopwatch.h"

namespace twopass {
namespace {

constexpr IntegratorKind kinds[] = {IntegratorKind::path, IntegratorKind::unbiased, IntegratorKind::two_pass};
constexpr double goal = 1e-3, full_size = 512.0 * 512.0;

struct Settings {
  int size = 64, samples = 64, renders = 8;
};

struct Result {
  std::vector<Image> images;
  double cpu_seconds = 0.0, rays = 0.0;
  double before = 0.0;  // CPU seconds of radiosity and guide
};

// The mean of the renders, the relative variance of one of them, and the mean of all pixels.
struct Summary {
  Image mean;
  double relmse = 0.0, level = 0.0, level_error = 0.0;
};

Summary summarise(const std::vector<Image>& images) {
  Summary s{images[0]};
  const auto n = static_cast<double>(images.size());
  for (int y = 0; y < s.mean.height; ++y)
    for (int x = 0; x < s.mean.width; ++x)
      for (int c = 0; c < 3; ++c) {
        double mean = 0.0, squares = 0.0;
        for (const Image& image : images) mean += image.at(x, y, c) / n;
        for (const Image& image : images) squares += (image.at(x, y, c) - mean) * (image.at(x, y, c) - mean);
        s.relmse += squares / (n - 1) / (mean * mean + relmse_epsilon);
        s.level += mean;
        s.mean.pixels[static_cast<std::size_t>(y * s.mean.width + x) * s.mean.channels.size() +
                      static_cast<std::size_t>(c)] = static_cast<float>(mean);
      }
  s.relmse /= 3.0 * s.mean.width * s.mean.height;
  s.level /= 3.0 * s.mean.width * s.mean.height;
  for (const Image& image : images) {
    double level = 0.0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < 3; ++c) level += image.at(x, y, c);
    s.level_error += std::pow(level / (3.0 * image.width * image.height) - s.level, 2.0);
  }
  s.level_error = std::sqrt(s.level_error / (n - 1) / n);
  return s;
}

// Of the differences of two means.
double difference(const Image& a, const Image& b) {
  double sum = 0.0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const double d = a.at(x, y, c) - b.at(x, y, c);
        sum += d * d / (b.at(x, y, c) * b.at(x, y, c) + relmse_epsilon);
      }
  return sum / (3.0 * a.width * a.height);
}

void run(const std::string& file, const Settings& settings) {
  const LoadedScene loaded = load_scene(file, {});
  const Scene scene(loaded.scene);
  const Camera camera(*loaded.scene.camera, settings.size, settings.size);
  const PathLimits limits{.max_depth = loaded.settings.max_depth};
  Stopwatch stopwatch;
  const Solution solution = solve_radiosity(scene);
  const double radiosity = stopwatch.elapsed().cpu_seconds;
  stopwatch = Stopwatch();
  const Guide guide(scene, solution);
  const double guiding = stopwatch.elapsed().cpu_seconds;
  std::vector<std::unique_ptr<Integrator>> integrators;
  std::vector<Result> results(std::size(kinds));
  for (std::size_t i = 0; i < results.size(); ++i) {
    stopwatch = Stopwatch();
    integrators.push_back(make_integrator(
        kinds[i], scene,
        {reads_solution(kinds[i]) ? &solution : nullptr, nullptr, is_guided(kinds[i]) ? &guide : nullptr},
        limits));
    results[i].before = stopwatch.elapsed().cpu_seconds + (reads_solution(kinds[i]) ? radiosity : 0.0) +
                        (is_guided(kinds[i]) ? guiding : 0.0);
  }
  for (int k = 0; k < settings.renders; ++k)
    for (std::size_t i = 0; i < results.size(); ++i) {
      Film film(settings.size, settings.size);
      stopwatch = Stopwatch();
      const RenderOutcome outcome =
          render_image({*integrators[i],
                        camera,
                        box_filter(),
                        {settings.samples, 0.0, 0.0},
                        static_cast<std::uint32_t>(k + 1) * 16 + static_cast<std::uint32_t>(i),
                        SamplerKind::sobol,
                        {},
                        {}},
                       film);
      results[i].cpu_seconds += stopwatch.elapsed().cpu_seconds;
      results[i].rays += static_cast<double>(outcome.counts.rays + outcome.counts.shadow_rays);
      results[i].images.push_back(film.resolve());
    }
  std::printf("%s: radiosity %.2f CPU s, guide %.2f CPU s (%zu cells, %.2g rays, %zu KB)\n", file.c_str(),
              radiosity, guiding, guide.cell_count(), static_cast<double>(guide.rays()),
              guide.memory_bytes() / 1024);
  std::printf("%-10s %10s %9s %9s %8s %8s %10s %9s %9s %9s\n", "integrator", "relMSE*spp", "us", "rays",
              "energy", "+-", "bias^2", "CPU s", "faster", "by rays");
  const double samples =
      static_cast<double>(settings.size) * settings.size * settings.samples * settings.renders;
  const Summary truth = summarise(results[0].images);
  double truth_seconds = 0.0, truth_rays = 0.0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const Result& r = results[i];
    const Summary s = summarise(r.images);
    const double noise = (s.relmse + truth.relmse) / settings.renders;
    const double bias = i == 0 ? 0.0 : difference(s.mean, truth.mean) - noise;
    const double v = s.relmse * settings.samples, rays = v * r.rays / samples;
    const double seconds = r.before + v / goal * full_size * r.cpu_seconds / samples;
    if (i == 0) truth_seconds = seconds, truth_rays = rays;
    std::printf("%-10s %10.4g %9.3f %9.2f %8.4f %8.4f %10.2g %9.2f %9.2f %9.2f\n",
                std::string(name_of_value<IntegratorKind>(integrator_names, kinds[i])).c_str(), v,
                1e6 * r.cpu_seconds / samples, r.rays / samples, s.level / truth.level,
                std::hypot(s.level_error, i == 0 ? 0.0 : truth.level_error) / truth.level, bias, seconds,
                truth_seconds / seconds, truth_rays / rays);
  }
}

}  // namespace
}  // namespace twopass

int main(int argc, char** argv) {
  using namespace twopass;
  Settings settings;
  if (argc > 1) settings.size = std::atoi(argv[1]);
  if (argc > 2) settings.samples = std::atoi(argv[2]);
  if (argc > 3) settings.renders = std::atoi(argv[3]);
  std::vector<std::string> files(argv + std::min(argc, 4), argv + argc);
  if (files.empty())
    for (const char* name : {"cornell-box", "cove", "hidden", "cornell-box-specular", "door-ajar"})
      files.push_back(std::string(TWOPASS_SOURCE_DIR "/scenes/") + name + "/scene.xml");
  for (const std::string& file : files) run(file, settings);
}
