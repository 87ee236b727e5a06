// What the benches of sampling share: their arguments, scenes by name, and the relMSE of pictures, true or by
// how they differ from each other.
#pragma once

#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "integrators/path.h"
#include "render/image/compare.h"
#include "render/load/load.h"
#include "render/render_image.h"

namespace twopass::bench {

/// [size [runs [scene ...]]], with defaults for what is not given.
struct Arguments {
  int size, runs;
  std::vector<std::string> scenes;

  Arguments(int argc, char** argv, Arguments defaults) : Arguments(std::move(defaults)) {
    if (argc > 1) size = std::atoi(argv[1]);
    if (argc > 2) runs = std::atoi(argv[2]);
    if (argc > 3) scenes.assign(argv + 3, argv + argc);
  }
  Arguments(int size_, int runs_, std::vector<std::string> scenes_)
      : size(size_), runs(runs_), scenes(std::move(scenes_)) {}
};

/// A square picture of a scene by `path`, as the scene file says but for the size; a box filter, because it
/// adds least to what the light itself varies.
class Subject {
 public:
  /// `scene`: a folder of scenes/, or a file. Throws Error.
  Subject(const std::string& scene, int size, const PathLimits* limits = nullptr)
      : loaded_(load_scene(
            scene.find('.') == std::string::npos ? TWOPASS_SOURCE_DIR "/scenes/" + scene + "/scene.xml" : scene,
            {})),
        camera_(*loaded_.scene.camera, size, size),
        size_(size),
        scene_(loaded_.scene),
        path_(scene_, limits ? *limits : PathLimits{.max_depth = loaded_.settings.max_depth}) {}

  [[nodiscard]] const LoadedScene& loaded() const { return loaded_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }
  /// Renders to the goal; what it took.
  RenderOutcome render(Film& film, const SamplingGoal& goal, std::uint32_t seed,
                       SamplerKind sampler = SamplerKind::sobol) const {
    return render_with(path_, film, goal, seed, sampler);
  }
  RenderOutcome render_with(const Integrator& integrator, Film& film, const SamplingGoal& goal,
                            std::uint32_t seed, SamplerKind sampler = SamplerKind::sobol) const {
    return render_image({integrator, camera_, box_filter(), goal, seed, sampler, {}}, film);
  }
  [[nodiscard]] Film film() const { return Film(size_, size_); }

 private:
  LoadedScene loaded_;
  Camera camera_;
  int size_;
  Scene scene_;
  PathTracer path_;
};

/// A converged picture and the relMSE that it still has itself, by the scatter of its batches.
struct Reference {
  Film film;
  double own_relmse;
};

inline Reference make_reference(const Subject& subject, int samples) {
  Reference reference{subject.film(), 0.0};
  // In parts of independent seeds: batches of one sequence scatter more than their sum errs.
  constexpr int parts = 16;
  for (int part = 0; part < parts; ++part) {
    Film film = subject.film();
    subject.render(film, {samples / parts, 0.0, 0.0}, 0x7ef00000u + static_cast<std::uint32_t>(part));
    for (int y = 0; y < film.height(); ++y)
      for (int x = 0; x < film.width(); ++x) {
        FilmPixel pixel = film.pixel(x, y);
        pixel.spread = C3d(0.0, 0.0, 0.0);
        pixel.batches = 1;
        reference.film.merge_pixel(x, y, pixel);
      }
  }
  const double error = reference.film.relative_error();
  reference.own_relmse = error * error;
  return reference;
}

/// relMSE of a film against the truth: what it has against the reference, less what the reference adds.
inline double true_relmse(const Film& film, const Reference& reference) {
  double sum = 0.0;
  for (int y = 0; y < film.height(); ++y)
    for (int x = 0; x < film.width(); ++x) {
      const C3d a = film.pixel(x, y).mean(), r = reference.film.pixel(x, y).mean();
      for (int c = 0; c < 3; ++c) sum += (a[c] - r[c]) * (a[c] - r[c]) / (r[c] * r[c] + relmse_epsilon);
    }
  return sum / (3.0 * film.width() * film.height()) - reference.own_relmse;
}

/// relMSE of one of several pictures, from how they differ from each other: independent renders need no
/// reference.
inline double relmse_between(std::span<const Image> images) {
  const auto n = static_cast<double>(images.size());
  const int width = images[0].width, height = images[0].height;
  double sum = 0.0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) {
        double mean = 0.0, squares = 0.0;
        for (const Image& image : images) mean += image.at(x, y, c) / n;
        for (const Image& image : images) squares += (image.at(x, y, c) - mean) * (image.at(x, y, c) - mean);
        sum += squares / (n - 1.0) / (mean * mean + relmse_epsilon);
      }
  return sum / (3.0 * width * height);
}

}  // namespace twopass::bench
