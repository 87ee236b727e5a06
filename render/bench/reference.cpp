#include "render/bench/reference.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "integrators/make_integrator.h"
#include "render/core/interrupt.h"
#include "render/image/compare.h"
#include "render/image/exr.h"
#include "render/render_image.h"
#include "render/stopwatch.h"
#include "render/version.h"

namespace twopass {

namespace fs = std::filesystem;

namespace {

constexpr int part_count = 16;
constexpr std::uint32_t first_seed = 0x7ef00000u;  // far from the seeds that are measured

fs::path cache_file(const BenchSubject& subject, const fs::path& folder) {
  std::string name;  // as a file can be called
  for (const char c : subject.name) name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '-';
  return folder / (name + "-" + std::to_string(subject.width) + "x" + std::to_string(subject.height) + "-" +
                   subject.fingerprint() + ".exr");
}

constexpr const char* channel_names[] = {"R", "G", "B", "variance.R", "variance.G", "variance.B"};

float metadata_number(const ExrMetadata& metadata, std::string_view name) {
  for (const auto& [key, value] : metadata)
    if (const auto* number = std::get_if<float>(&value); number != nullptr && key == name) return *number;
  return 0.0f;
}

std::optional<BenchReference> cached(const fs::path& file, double seconds) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return std::nullopt;
  ExrMetadata metadata;
  const Image image = read_exr(file, &metadata);
  BenchReference reference;
  reference.seconds = metadata_number(metadata, "twopass/seconds");
  reference.samples_per_pixel = metadata_number(metadata, "twopass/spp");
  // By what it was allowed: what it took depends on what else the machine did.
  if (metadata_number(metadata, "twopass/budget") < 0.5 * seconds) return std::nullopt;
  std::array<int, 6> channels{};
  for (std::size_t c = 0; c < 6; ++c) {
    channels[c] = image.channel(channel_names[c]);
    if (channels[c] < 0) return std::nullopt;
  }
  reference.picture = Image(image.width, image.height, {"R", "G", "B"});
  reference.variance.resize(image.pixel_count());
  for (std::size_t i = 0; i < image.pixel_count(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const auto value = [&](std::size_t k) {
        return image.pixels[i * image.channels.size() + static_cast<std::size_t>(channels[k])];
      };
      reference.picture.pixels[3 * i + c] = value(c);
      reference.variance[i][static_cast<int>(c)] = value(3 + c);
    }
  reference.was_cached = true;
  return reference;
}

void keep(const BenchReference& reference, double budget, const fs::path& file) {
  Image image(reference.picture.width, reference.picture.height,
              {std::begin(channel_names), std::end(channel_names)});
  for (std::size_t i = 0; i < image.pixel_count(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      image.pixels[6 * i + c] = reference.picture.pixels[3 * i + c];
      image.pixels[6 * i + 3 + c] = reference.variance[i][static_cast<int>(c)];
    }
  ExrOptions options;
  options.pixel_type = PixelType::float_;
  options.float_layers = {"variance"};
  options.metadata = {{"twopass/version", std::string(program_version)},
                      {"twopass/integrator", std::string("path")},
                      {"twopass/spp", static_cast<float>(reference.samples_per_pixel)},
                      {"twopass/seconds", static_cast<float>(reference.seconds)},
                      {"twopass/budget", static_cast<float>(budget)}};
  write_exr(file, image, options);
}

// Means and squares of the parts, each a picture of as many samples.
class Parts {
 public:
  explicit Parts(std::size_t pixels) : sum_(pixels, C3d(0.0)), squares_(pixels, C3d(0.0)) {}
  void add(const Film& film) {
    ++count_;
    for (std::size_t i = 0; i < sum_.size(); ++i) {
      const C3d mean =
          film.pixel(static_cast<int>(i) % film.width(), static_cast<int>(i) / film.width()).mean();
      sum_[i] += mean;
      squares_[i] += mean * mean;
    }
  }
  [[nodiscard]] int count() const { return count_; }
  // REQUIRES: at least two parts.
  void resolve(BenchReference& reference) const {
    const double n = count_;
    reference.variance.resize(sum_.size());
    for (std::size_t i = 0; i < sum_.size(); ++i)
      for (int c = 0; c < 3; ++c) {
        const double mean = sum_[i][c] / n;
        reference.picture.pixels[3 * i + static_cast<std::size_t>(c)] = static_cast<float>(mean);
        reference.variance[i][c] =
            static_cast<float>(std::max(0.0, squares_[i][c] / n - mean * mean) / (n - 1.0));
      }
  }

 private:
  std::vector<C3d> sum_, squares_;
  int count_ = 0;
};

BenchReference rendered(const BenchSubject& subject, double seconds) {
  const std::unique_ptr<Integrator> path =
      make_integrator(IntegratorKind::path, subject.scene, {}, subject.limits);
  const auto render = [&](Film& film, int samples, std::uint32_t seed) {
    render_image({.integrator = *path,
                  .camera = subject.camera,
                  .filter = box_filter(),
                  .goal = {samples, 0.0, 0.0},
                  .seed = seed,
                  .cone = subject.cone},
                 film);
    if (interrupt_requested()) return false;
    return true;
  };
  const Stopwatch stopwatch;
  // How many samples fit is found by doubling.
  int samples = 1;
  double last = 0.0;
  for (; samples < most_samples_per_pixel; samples *= 2) {
    Film film(subject.width, subject.height);
    const Stopwatch one;
    if (!render(film, samples, first_seed - 1)) throw Interrupted{};
    last = one.seconds();
    if (2.0 * last > 0.5 * seconds / part_count) break;
  }
  samples =
      std::max(samples, static_cast<int>(samples * (seconds - stopwatch.seconds()) / (part_count * last)));
  samples = std::min(samples, most_samples_per_pixel);
  BenchReference reference;
  reference.picture = Image(subject.width, subject.height, {"R", "G", "B"});
  Parts parts(reference.picture.pixel_count());
  for (std::uint32_t part = 0; part < part_count; ++part) {
    Film film(subject.width, subject.height);
    if (!render(film, samples, first_seed + part)) break;
    parts.add(film);
  }
  if (parts.count() < 2) throw Interrupted{};
  parts.resolve(reference);
  reference.samples_per_pixel = static_cast<double>(samples) * parts.count();
  reference.seconds = stopwatch.seconds();
  return reference;
}

}  // namespace

void estimate_own_error(BenchReference& reference) {
  double relmse = 0.0, mse = 0.0;
  for (std::size_t i = 0; i < reference.variance.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double r = reference.picture.pixels[3 * i + static_cast<std::size_t>(c)],
                   v = reference.variance[i][c];
      relmse += v / (r * r + relmse_epsilon);
      mse += v;
    }
  const double values = 3.0 * static_cast<double>(reference.variance.size());
  reference.relmse = relmse / values;
  reference.mse = mse / values;
}

BenchReference bench_reference(const BenchSubject& subject, double seconds, const fs::path& folder) {
  const fs::path file = cache_file(subject, folder);
  std::optional<BenchReference> reference = cached(file, seconds);
  if (!reference) {
    reference = rendered(subject, seconds);
    // One that the user cut short is not worth keeping.
    if (!interrupt_requested()) keep(*reference, seconds, file);
  }
  estimate_own_error(*reference);
  return *std::move(reference);
}

}  // namespace twopass
