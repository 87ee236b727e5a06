// twopass bench: error against run time.
#include <cstdio>

#include "render/bench/cycles.h"
#include "render/bench/results.h"
#include "render/commands/command.h"
#include "render/commands/scene_options.h"
#include "render/core/interrupt.h"
#include "render/core/parallel.h"
#include "render/image/atomic_file.h"
#include "render/web/bench_page.h"

namespace twopass {

namespace {

namespace fs = std::filesystem;

struct BenchOptions {
  std::vector<std::string> scenes;
  std::string folder, references;
  std::vector<std::string> integrators{"twopass", "unbiased", "path"};
  std::vector<std::string> solvers, form_factors;
  int seeds = 0, size = 0;
  std::size_t elements = 0;
  double minutes = 0.0, seconds = 0.0, reference_seconds = 0.0, relmse = 0.0;
  bool quick = false, pass_one = false, peers = true;
};

// The time of a scene is divided between its reference and its methods, and that of a method between its seeds.
constexpr double full_minutes = 18.0, quick_minutes = 1.5;
constexpr double reference_share = 0.4;

void settle(BenchOptions& options) {
  if (options.minutes == 0.0) options.minutes = options.quick ? quick_minutes : full_minutes;
  if (options.seeds == 0) options.seeds = options.quick ? 2 : 3;
  if (options.size == 0) options.size = options.quick ? 64 : 128;
  if (options.elements == 0) options.elements = options.quick ? 500 : 1500;
  if (options.references.empty()) options.references = options.folder + "/references";
  if (options.scenes.empty())
    for (const fs::path& scene : gallery_scenes()) options.scenes.push_back(scene.string());
  if (options.solvers.empty())
    options.solvers = {"gauss-seidel", "cg", "progressive", "lu", "hierarchical", "stochastic"};
  if (options.form_factors.empty()) options.form_factors = {"rays", "hemicube", "point", "exact"};
}

void make_folder(const std::string& folder) {
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem || !fs::is_directory(folder))
    throw Error(folder, problem ? problem.message() : "it is no folder", "choose a folder that can be written");
  check_writable(fs::path(folder) / "results.json");
}

// Counts seconds of the budget over all scenes.
class BudgetProgress {
 public:
  BudgetProgress(const Console& console, double seconds) : progress_(console, "benchmark"), all_(seconds) {}
  void set(double seconds) { progress_.update(std::min(1.0, (done_ + seconds) / all_)); }
  void finish(double seconds) {
    done_ += seconds;
    set(0.0);
  }

 private:
  Progress progress_;
  double all_, done_ = 0.0;
};

class Bench {
 public:
  Bench(const BenchOptions& options, const GlobalOptions& global)
      : options_(options), console_(global.console()), quiet_(Verbosity::quiet), limit_(global.threads) {
    for (const std::string& name : options_.integrators)
      kinds_.push_back(value_of_name<IntegratorKind>(integrator_names, name, "--integrators", "integrator"));
    for (const std::string& name : options_.solvers)
      solvers_.push_back(value_of_name<Solver>(solver_names, name, "--solvers", "solver"));
    for (const std::string& name : options_.form_factors)
      methods_.push_back(value_of_name<FormFactorMethod>(form_factor_method_names, name, "--form-factors",
                                                         "form factor method"));
    results_.machine = machine_text(limit_.threads());
    results_.versions = versions_text();
    results_.threads = limit_.threads();
    has_cycles_ = options_.peers && !options_.pass_one && has_blender();
  }

  int run(const std::string& command) {
    results_.command = command;
    make_folder(options_.folder);
    make_folder(options_.references);
    const double seconds = 60.0 * options_.minutes;
    {
      BudgetProgress progress(console_, seconds);
      for (const std::string& scene : options_.scenes) {
        if (interrupt_requested()) break;
        try {
          measure_scene(scene, seconds / static_cast<double>(options_.scenes.size()), progress);
        } catch (const Interrupted&) {
          break;
        } catch (const Error& error) {
          failures_.push_back(error.what());
        }
        write();
      }
    }
    results_.is_complete = !interrupt_requested() && failures_.empty();
    write();
    report();
    for (const std::string& failure : failures_) std::fprintf(stderr, "%s\n", failure.c_str());
    if (interrupt_requested()) {
      console_.note("interrupted: kept what was done");
      return exit_interrupted();
    }
    return failures_.empty() ? 0 : 1;
  }

 private:
  void measure_scene(const std::string& file, double seconds, BudgetProgress& progress) {
    SceneOptions scene_options;
    scene_options.file = file;
    const BenchSubject subject(file, scene_options.load(quiet_, SceneOptions::Additions::light_and_camera, {}),
                               options_.size);
    BenchScene found;
    found.name = subject.name;
    found.file = file;
    found.fingerprint = subject.fingerprint();
    found.width = subject.width;
    found.height = subject.height;
    for (const Shape& shape : subject.scene.shapes())
      if (const Mesh* mesh = mesh_of(shape.geometry)) found.triangles += mesh->triangles.size();
    const double for_reference =
        options_.reference_seconds > 0.0 ? options_.reference_seconds : reference_share * seconds;
    found.reference = bench_reference(subject, for_reference, options_.references);
    progress.finish(reference_share * seconds);
    BenchScene& scene = results_.scenes.emplace_back(std::move(found));
    const double rest = (1.0 - reference_share) * seconds;
    if (options_.pass_one)
      measure_pass_one_of(subject, scene, rest, progress);
    else
      measure_methods(subject, scene, rest, progress);
  }

  void measure_methods(const BenchSubject& subject, BenchScene& scene, double seconds,
                       BudgetProgress& progress) {
    std::string unfit;
    if (!options_.peers)
      unfit = "--no-peers was given";
    else if (!has_cycles_)
      unfit = "there is no blender on the PATH (apt-get install blender)";
    else
      unfit = unfit_for_cycles(subject);
    if (!unfit.empty()) scene.notes.push_back("Blender Cycles is left out: " + unfit + ".");
    const double share = seconds / static_cast<double>(kinds_.size() + (unfit.empty() ? 1 : 0));
    const double a_run = options_.seconds > 0.0 ? options_.seconds : share / options_.seeds;
    const SeriesBudget budget{a_run, options_.relmse, options_.seeds};
    const auto set = [&](double spent) { progress.set(std::min(spent, share)); };
    for (const IntegratorKind kind : kinds_) {
      if (interrupt_requested()) return;
      scene.series.push_back(measure_series(subject, kind, scene.reference, budget, set));
      progress.finish(share);
      write();
    }
    if (!unfit.empty() || interrupt_requested()) return;
    scene.series.push_back(
        measure_cycles(subject, scene.reference, budget, limit_.threads(), options_.folder, set));
    progress.finish(share);
  }

  void measure_pass_one_of(const BenchSubject& subject, BenchScene& scene, double seconds,
                           BudgetProgress& progress) {
    const Plan plan = plan_render(subject.needs, IntegratorKind::radiosity, subject.limits);
    if (!plan.radiosity_pass) {
      for (const Skipped& skipped : plan.skipped) scene.notes.push_back(skipped.what + ": " + skipped.why);
      return;
    }
    const double share = seconds / static_cast<double>(solvers_.size() * methods_.size());
    for (const Solver solver : solvers_) {
      // Those two find their own form factors.
      const bool has_own = solver == Solver::hierarchical || solver == Solver::stochastic;
      for (const FormFactorMethod method : methods_) {
        if (interrupt_requested()) return;
        progress.finish(share);
        if (has_own && method != methods_.front()) continue;
        RadiosityOptions radiosity;
        radiosity.solver = solver;
        radiosity.form_factors = has_own ? FormFactorMethod::automatic : method;
        radiosity.max_elements = options_.elements;
        radiosity.subdivision = Subdivision::uniform;
        try {
          scene.pass_one.push_back(measure_pass_one(subject, radiosity, scene.reference));
        } catch (const Error& error) {
          scene.notes.push_back(error.what());  // a method that cannot do this scene
        }
      }
    }
  }

  static void write_text(const fs::path& file, const std::string& text) {
    write_atomically(file, std::as_bytes(std::span(text)));
  }
  void write() const {
    const fs::path folder = options_.folder;
    write_text(folder / "results.json", results_json(results_));
    write_text(folder / (options_.pass_one ? "pass_one.csv" : "results.csv"),
               options_.pass_one ? pass_one_csv(results_) : results_csv(results_));
    write_text(folder / "report.html", bench_page(results_, display_));
  }

  // The last point of each series.
  void report() const {
    if (console_.verbosity() == Verbosity::quiet) return;
    for (const BenchScene& scene : results_.scenes) {
      for (const BenchSeries& series : scene.series) {
        if (series.points.empty()) continue;
        const SeriesPoint& p = series.points.back();
        std::printf(
            "%-22s %-14s %6d spp %8.2f s  relmse %.3g (bias2 %.2g, variance %.3g)  energy %.4f %.4f %.4f\n",
            scene.name.c_str(), series.method.c_str(), p.samples_per_pixel, p.time.seconds, p.relmse, p.bias2,
            p.variance, p.energy_ratio.x, p.energy_ratio.y, p.energy_ratio.z);
      }
      for (const PassOneResult& r : scene.pass_one)
        std::printf("%-22s %-13s %-9s %6zu elements %8.3f s  relmse %.3g  energy %.4f %.4f %.4f\n",
                    scene.name.c_str(), r.solver.c_str(), r.form_factors.c_str(), r.stats.elements,
                    r.time.seconds, r.relmse, r.energy_ratio.x, r.energy_ratio.y, r.energy_ratio.z);
      for (const std::string& note : scene.notes) console_.detail(scene.name + ": " + note);
    }
    std::printf("wrote %s/report.html, results.json and %s\n", options_.folder.c_str(),
                options_.pass_one ? "pass_one.csv" : "results.csv");
  }

  const BenchOptions& options_;
  Console console_, quiet_;
  ThreadLimit limit_;
  DisplayTransform display_;
  std::vector<IntegratorKind> kinds_;
  std::vector<Solver> solvers_;
  std::vector<FormFactorMethod> methods_;
  bool has_cycles_ = false;
  BenchResults results_;
  std::vector<std::string> failures_;
};

std::string command_text(const BenchOptions& options) {
  std::string text = "twopass bench, " + std::to_string(options.scenes.size()) + " scenes, " +
                     std::to_string(options.size) + " pixels, " + std::to_string(options.seeds) + " seeds, ";
  char budget[80];
  std::snprintf(budget, sizeof budget, "%.3g minutes in all", options.minutes);
  return text + budget;
}

}  // namespace

void add_bench_command(CLI::App& program, const GlobalOptions& global, Action& action) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App& command = *program.add_subcommand("bench", "Error against run time, for every integrator");
  command.add_option("scenes", options->scenes, "Scenes to render (default: the gallery of the program)");
  command.add_option("-o,--output", options->folder, "Folder for results.json, results.csv and report.html")
      ->required();
  command.add_option("--integrators", options->integrators, "Those to measure")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  command.add_flag("--quick", options->quick, "Small pictures, in less than two minutes");
  command
      .add_option("--minutes", options->minutes,
                  "Time for all scenes together, references included (default: 18, quick 1.5)")
      ->check(CLI::PositiveNumber);
  command.add_option("--time", options->seconds, "Seconds a run instead of its share of the minutes")
      ->check(CLI::PositiveNumber);
  command.add_option("--error", options->relmse, "End a run early at this relMSE")->check(CLI::PositiveNumber);
  command
      .add_option("--reference-time", options->reference_seconds,
                  "Seconds for each reference (default: two fifths of the scene's share)")
      ->check(CLI::PositiveNumber);
  command.add_option("--references", options->references,
                     "Folder in which references are kept (default: references in the output folder)");
  command.add_option("--seeds", options->seeds, "Runs of each integrator (default: 3, quick 2)")
      ->check(CLI::Range(1, 1000));
  command.add_option("--size", options->size, "Longer side of the pictures, pixels (default: 128, quick 64)")
      ->check(CLI::Range(8, 4096));
  command.add_flag("!--no-peers", options->peers,
                   "Leave out Blender Cycles, which is measured where it is installed");
  CLI::Option* pass_one = command.add_flag("--pass-one", options->pass_one,
                                           "Measure the radiosity pass alone: solvers x form factors");
  command.add_option("--solvers", options->solvers, "Those to measure")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->needs(pass_one);
  command.add_option("--form-factors", options->form_factors, "Those to measure")
      ->delimiter(',')
      ->needs(pass_one);
  command.add_option("--elements", options->elements, "Most elements (default: 1500, quick 500)")
      ->check(CLI::Range(1, 1 << 30))
      ->needs(pass_one);
  command.callback([options, &global, &action] {
    action = [options, &global] {
      settle(*options);
      return Bench(*options, global).run(command_text(*options));
    };
  });
}

}  // namespace twopass
