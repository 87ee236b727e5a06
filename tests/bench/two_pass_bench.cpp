// The bars of the two-pass method: CPU seconds to a relMSE, pass one and certificate included, for each
// integrator side by side. References are two independent pictures A and B by `path`, kept in a folder to be
// used again. With T a picture that is independent of both, the mean of (T - A)(T - B) / (r^2 + 0.01), r = (A +
// B) / 2, has the expectation of T's relMSE whatever noise A and B have; with two pictures T1 and T2 of the
// same pass one, that of (T1 - A)(T2 - B) is the squared bias alone: the floor that more samples do not get
// below. two_pass_bench --help says how to call it.
#include <cstdio>

#include <CLI/CLI.hpp>

#include "render/image/compare.h"
#include "render/image/exr.h"
#include "render/load/load.h"
#include "render/pass_one.h"
#include "render/render_image.h"
#include "render/view_probe.h"

namespace twopass {
namespace {

struct Options {
  int size = 512, reference_samples = 128, most_samples = 64;
  double goal = 1e-3, density = 1.0;
  std::filesystem::path cache = "build/references";
  std::vector<std::string> integrators{"path", "unbiased", "twopass"}, scenes;
  std::vector<int> fixed_samples;
  int refinement = 0;
  SamplingGoal picture;
  bool is_judged = false;
  bool gathers = false, gathers_twice = false, by_noise = false, keep_pass_one = false;
  std::string write;
};

// A picture of so many pixels in all as a square of the given size has, in the proportions of the scene.
V2i picture_size(const FileSettings& settings, int size) {
  const double shape = std::sqrt(static_cast<double>(settings.width) / settings.height);
  return {std::max(1, static_cast<int>(std::lround(size * shape))),
          std::max(1, static_cast<int>(std::lround(size / shape)))};
}

// What a render of one integrator took, and the picture.
struct Run {
  Image image;
  double samples = 0.0;      // a pixel
  double cpu_seconds = 0.0;  // of pass two
  double certificate_seconds = 0.0;
  std::optional<Certificate> certificate;
};

// A mean over pixels and channels with its standard error.
struct Mean {
  double value, error;
};

class Subject {
 public:
  Subject(const std::string& file, const Options& options)
      : options_(options),
        loaded_(load_scene(file, {})),
        size_(picture_size(loaded_.settings, options.size)),
        camera_(*loaded_.scene.camera, size_.x, size_.y),
        limits_{.max_depth = loaded_.settings.max_depth, .hide_emitters = loaded_.settings.hide_emitters},
        needs_(needs_of(loaded_.scene)),
        scene_(std::move(loaded_.scene)),
        name_(std::filesystem::path(file).parent_path().filename().string()) {}

  [[nodiscard]] V2i size() const { return size_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] Plan plan(IntegratorKind kind, PictureGoal& goal) const {
    Plan plan = plan_render(needs_, kind, limits_);
    if (options_.keep_pass_one) return plan;
    const PixelWindow window{{0, 0}, size_};
    goal = picture_goal(
        options_.picture, window, 1,
        fit_to_view(plan, kind, scene_, camera_, window, limits_, 0, rays_of(options_.picture, window, 1)));
    return plan;
  }

  [[nodiscard]] PreparedPassOne prepare(IntegratorKind kind, const Plan& plan, const PictureGoal& goal) const {
    RadiosityOptions radiosity = radiosity_options(kind, limits_, camera_, {{0, 0}, size_}, {}, goal);
    radiosity.gathered_pixels =
        static_cast<std::size_t>(options_.density * static_cast<double>(radiosity.gathered_pixels));
    radiosity.refinement = options_.refinement;
    PassOneJob job{.scene = scene_,
                   .plan = plan,
                   .integrator = kind,
                   .radiosity = std::move(radiosity),
                   .picture_rays = goal.rays};
    const bool is_judged = options_.is_judged && kind == IntegratorKind::two_pass && plan.radiosity_pass;
    PreparedPassOne done =
        is_judged
            ? prepare_within_bias(std::move(job), camera_, {{0, 0}, size_}, limits_,
                                  bias_goal(options_.picture, {{0, 0}, size_}, 1),
                                  [](const std::string& step) { std::fprintf(stderr, "%s\n", step.c_str()); })
            : prepare_pass_one(std::move(job));
    if (options_.gathers) done.field.reset();
    done.gathers_twice = options_.gathers_twice;
    return done;
  }

  [[nodiscard]] Run render(IntegratorKind kind, const PreparedPassOne& pass_one, const SamplingGoal& goal,
                           std::uint32_t seed) const {
    const auto integrator = make_integrator(kind, scene_, pass_one.view(), limits_);
    Film film(size_.x, size_.y);
    const RayCone cone =
        scene_.has_textures() ? sample_cone(camera_, size_.x, size_.y, goal.samples_per_pixel) : RayCone{};
    Run run;
    Stopwatch stopwatch;
    const RenderOutcome outcome = render_image({.integrator = *integrator,
                                                .camera = camera_,
                                                .filter = loaded_.settings.filter,
                                                .goal = goal,
                                                .seed = seed,
                                                .cone = cone},
                                               film);
    run.cpu_seconds = stopwatch.elapsed().cpu_seconds;
    run.image = film.resolve();
    run.samples = static_cast<double>(film.samples()) / size_.x / size_.y;
    if (kind == IntegratorKind::two_pass && pass_one.solution) {
      stopwatch = Stopwatch();
      run.certificate = certify_picture({.scene = scene_,
                                         .pass_one = pass_one,
                                         .integrator = *integrator,
                                         .limits = limits_,
                                         .camera = camera_,
                                         .window = {{0, 0}, size_},
                                         .seed = seed,
                                         .counts = outcome.counts});
      run.certificate_seconds = stopwatch.elapsed().cpu_seconds;
    }
    return run;
  }

  // The picture `half` (0 or 1) of the reference, from the cache or for it.
  [[nodiscard]] Image reference(std::uint32_t half) const {
    const std::filesystem::path file =
        options_.cache / (name_ + "-" + std::to_string(size_.x) + "x" + std::to_string(size_.y) + "-" +
                          std::to_string(options_.reference_samples) + "-" + std::to_string(half) + ".exr");
    if (std::filesystem::exists(file)) return read_exr(file);
    std::filesystem::create_directories(options_.cache);
    Image image =
        render(IntegratorKind::path, {}, {options_.reference_samples, 0.0, 0.0}, 0x7ef00000u + half).image;
    write_exr(file, image, {.pixel_type = PixelType::float_});
    return image;
  }

 private:
  const Options& options_;
  LoadedScene loaded_;
  V2i size_;
  Camera camera_;
  PathLimits limits_;
  SceneNeeds needs_;
  Scene scene_;
  std::string name_;
};

struct Reference {
  Image a, b;

  // The mean of (t1 - a)(t2 - b), relative to the squared mean of a and b.
  [[nodiscard]] Mean product(const Image& t1, const Image& t2) const {
    double sum = 0.0, squares = 0.0;
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x) {
        double value = 0.0;
        for (int c = 0; c < 3; ++c) {
          const double r = 0.5 * (a.at(x, y, c) + b.at(x, y, c));
          value += (t1.at(x, y, c) - a.at(x, y, c)) * (t2.at(x, y, c) - b.at(x, y, c)) /
                   (r * r + relmse_epsilon) / 3.0;
        }
        sum += value;
        squares += value * value;
      }
    const double n = static_cast<double>(a.pixel_count());
    return {sum / n, std::sqrt(squares) / n};
  }
  // Its own, of one half.
  [[nodiscard]] double relmse() const { return 0.5 * product(b, a).value * -1.0; }
};

double level(const Image& image) {
  double sum = 0.0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 3; ++c) sum += image.at(x, y, c);
  return sum;
}

// Samples a pixel at which the goal would be met if the error fell from (n0, e0) as it did to (n1, e1), but not
// faster than with n^-1.5 nor, as nothing is known of it, beyond (n1, e1) other than with 1/n.
double samples_to(double goal, double n0, double e0, double n1, double e1) {
  double power = 1.0;
  if (n0 > 0.0 && e1 < e0 && e1 <= goal) power = std::clamp(std::log(e0 / e1) / std::log(n1 / n0), 0.3, 1.5);
  return n1 * std::pow(e1 / goal, 1.0 / power);
}

struct Row {
  double seconds = 0.0;  // to the goal; infinite: its floor is higher
};

Row measure(const Subject& subject, const Reference& reference, IntegratorKind kind, const Options& options,
            double path_seconds) {
  const std::string name(name_of_value<IntegratorKind>(integrator_names, kind));
  PictureGoal goal_of_pass_one;
  const Plan plan = subject.plan(kind, goal_of_pass_one);
  const PreparedPassOne pass_one = subject.prepare(kind, plan, goal_of_pass_one);
  const double before = pass_one.time().cpu_seconds;
  for (const Skipped& skipped : plan.skipped)
    std::fprintf(stderr, "%s: skipped: %s, because %s\n", name.c_str(), skipped.what.c_str(),
                 skipped.why.c_str());
  if (pass_one.solution)
    std::fprintf(stderr, "%s: %zu elements %.2f CPU s, look-ups %.2f, guide %.2f\n", name.c_str(),
                 pass_one.solution->mesh().count(), pass_one.solution_time.cpu_seconds,
                 pass_one.field_time.cpu_seconds, pass_one.guide_time.cpu_seconds);
  if (const IndirectField* field = pass_one.field.get())
    std::fprintf(stderr, "all known %.2f of the area, indirect %.2f, no direct light %.2f\n",
                 field->share(Known::all), field->share(Known::indirect),
                 field->share(Known::no_direct) - field->share(Known::indirect));
  double n0 = 0.0, e0 = 0.0, n1 = 0.0, e1 = 0.0, slope = 0.0, certificate = 0.0;
  std::vector<SamplingGoal> ladder;
  for (const int n : options.fixed_samples) ladder.push_back({n, 0.0, 0.0});
  if (options.by_noise) ladder.push_back({0, 0.0, std::sqrt(options.goal)});
  if (ladder.empty())
    for (int n = 4; n <= options.most_samples; n *= 2) ladder.push_back({n, 0.0, 0.0});
  Mean error{}, floor{};
  double energy = 0.0;
  std::optional<Certificate> said;
  for (const SamplingGoal& goal : ladder) {
    const Run first = subject.render(kind, pass_one, goal, 1), second = subject.render(kind, pass_one, goal, 2);
    const double n = 0.5 * (first.samples + second.samples);
    const Mean e1a = reference.product(first.image, first.image),
               e1b = reference.product(second.image, second.image);
    error = {0.5 * (e1a.value + e1b.value), 0.5 * (e1a.error + e1b.error)};
    const Mean f1 = reference.product(first.image, second.image),
               f2 = reference.product(second.image, first.image);
    floor = {0.5 * (f1.value + f2.value), 0.5 * (f1.error + f2.error)};
    energy = (level(first.image) + level(second.image)) / (level(reference.a) + level(reference.b));
    n0 = n1, e0 = e1, n1 = n, e1 = error.value;
    slope = 0.5 * (first.cpu_seconds + second.cpu_seconds) / n;
    certificate = 0.5 * (first.certificate_seconds + second.certificate_seconds);
    said = first.certificate;
    if (!options.write.empty())
      write_exr(options.write + subject.name() + "-" + name + "-" + std::to_string(std::lround(n)) + ".exr",
                first.image, {.pixel_type = PixelType::float_});
    if (options.fixed_samples.empty() && e1 <= options.goal) break;
  }
  double samples = samples_to(options.goal, n0, e0, n1, e1);
  if (kind == IntegratorKind::path && !options.by_noise && n1 < options.reference_samples) {
    // The halves of the reference are such pictures, too.
    const double power = std::log(e1 / reference.relmse()) / std::log(options.reference_samples / n1);
    samples = n1 * std::pow(e1 / options.goal, 1.0 / std::clamp(power, 0.5, 1.5));
  }
  const bool reached = floor.value - 2.0 * floor.error < options.goal;
  const double seconds = reached ? before + samples * slope + certificate * samples / n1 : infinity_f;
  std::printf("| %s | %s | %.1f | %.2e +- %.0e | %.1e +- %.0e | %.4f | %.2f | %.3f | %.2f | %s%.1f | %.2f |",
              subject.name().c_str(), name.c_str(), n1, e1, error.error, floor.value, floor.error, energy,
              before, 1e6 * slope / subject.size().x / subject.size().y, certificate, samples > n1 ? "~" : "",
              seconds, path_seconds > 0.0 ? path_seconds / seconds : 1.0);
  if (said) std::printf(" %+.2f %% +- %.2f %%", 100.0 * said->mean, 100.0 * said->ci95);
  std::printf(" |\n");
  std::fflush(stdout);
  return {seconds};
}

void run(const std::string& file, const Options& options) {
  const Subject subject(file, options);
  const Reference reference{subject.reference(0), subject.reference(1)};
  std::fprintf(stderr, "%s, %dx%d: reference of twice %d samples, relMSE of either %.1e\n",
               subject.name().c_str(), subject.size().x, subject.size().y, options.reference_samples,
               reference.relmse());
  double path_seconds = 0.0;
  for (const std::string& name : options.integrators) {
    const auto kind = value_of_name<IntegratorKind>(integrator_names, name, "--integrators", "integrator");
    const Row row = measure(subject, reference, kind, options, path_seconds);
    if (kind == IntegratorKind::path) path_seconds = row.seconds;
  }
}

}  // namespace
}  // namespace twopass

int main(int argc, char** argv) {
  using namespace twopass;
  Options options;
  CLI::App app("CPU seconds to a relMSE, by integrator");
  app.add_option("scenes", options.scenes, "Scene files (default: those of the bars that are in scenes/)");
  app.add_option("--size", options.size, "Pictures have as many pixels as a square of this size");
  app.add_option("--goal", options.goal, "The relMSE");
  app.add_option("--cache", options.cache, "Folder of the references");
  app.add_option("--reference-spp", options.reference_samples,
                 "Samples a pixel of either half of the reference");
  app.add_option("--most-spp", options.most_samples,
                 "Renders with more samples are not made but extrapolated (~)");
  app.add_option("--spp", options.fixed_samples, "Measure at these numbers of samples alone")->delimiter(',');
  app.add_option("--integrators", options.integrators, "Which, path first")->delimiter(',');
  app.add_flag("--noise", options.by_noise, "Render to an estimated noise of the root of the goal instead");
  app.add_option("--density", options.density,
                 "Elements of twopass, over those that a picture gets by default");
  app.add_option("--refinement", options.refinement, "How often the number of elements is quadrupled");
  app.add_option("--for-spp", options.picture.samples_per_pixel,
                 "Pass one as render has it for a picture of so many samples a pixel");
  app.add_option("--for-noise", options.picture.relative_error, "Pass one as for a picture of this noise");
  app.add_flag("--judge", options.is_judged, "Judge pass one by its bias, as render does");
  app.add_flag("--gather", options.gathers, "Look nothing up where the camera looks");
  app.add_flag("--gather-twice", options.gathers_twice, "Gather over one more surface");
  app.add_flag("--keep-pass-one", options.keep_pass_one, "Also where the view gains too little by it");
  app.add_option("--write", options.write, "Beginning of the names of .exr files for the pictures");
  CLI11_PARSE(app, argc, argv);
  if (options.scenes.empty())
    for (const char* name : {"cornell-box", "cove", "hidden", "cornell-box-specular", "door-ajar"})
      options.scenes.push_back(std::string(TWOPASS_SOURCE_DIR "/scenes/") + name + "/scene.xml");
  std::printf(
      "| scene | integrator | spp | relMSE | bias^2 | energy | pass one, CPU s | us a sample | certificate, "
      "CPU s "
      "| CPU s to %g | faster | bias by certificate |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n",
      options.goal);
  try {
    for (const std::string& file : options.scenes) run(file, options);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
