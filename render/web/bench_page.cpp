#include "render/web/bench_page.h"

#include <cmath>

#include "render/image/error_view.h"
#include "render/web/log_plot.h"
#include "render/web/page_template.h"
#include "render/web/report.h"

namespace twopass {

namespace {

constexpr std::string_view ground_truth = "path";

// A table, cell by cell. What is added is HTML, and has to be escaped already.
class Table {
 public:
  Table(const std::string& caption, const std::vector<std::string>& heads) {
    html_ = "<div class=\"wide\"><table><caption>" + caption + "</caption>\n<thead><tr>";
    for (const std::string& head : heads) html_ += "<th scope=\"col\">" + head + "</th>";
    html_ += "</tr></thead>\n<tbody>\n";
  }
  void row(const std::string& head, const std::vector<std::string>& cells) {
    html_ += "<tr><th scope=\"row\">" + head + "</th>";
    for (const std::string& cell : cells) html_ += "<td class=\"n\">" + cell + "</td>";
    html_ += "</tr>\n";
  }
  [[nodiscard]] std::string finish() const { return html_ + "</tbody></table></div>\n"; }

 private:
  std::string html_;
};

std::string ratio_text(double ratio) { return std::isfinite(ratio) ? number_text(ratio, 3) + "x" : "-"; }

const BenchSeries* truth_of(const BenchScene& scene) {
  for (const BenchSeries& series : scene.series)
    if (series.method == ground_truth && !series.points.empty()) return &series;
  return nullptr;
}

// How much sooner than `path` a method has the error that `path` ends with: 0 where it cannot be said.
struct Gain {
  double seconds = std::numeric_limits<double>::infinity();
  double ratio = 0.0;  // lower bound where `is_bound`: the method was below the error from its first point on
  bool is_bound = false;
};
Gain gain_of(const BenchSeries& series, const BenchSeries& truth) {
  Gain gain;
  const SeriesPoint& goal = truth.points.back();
  if (series.points.empty() || goal.relmse <= 0.0) return gain;
  gain.seconds = time_to_error(series.points, goal.relmse);
  if (!std::isfinite(gain.seconds)) return gain;
  gain.ratio = goal.time.cpu_seconds / gain.seconds;
  gain.is_bound = series.points.front().relmse <= goal.relmse;
  return gain;
}

std::string gain_text(const Gain& gain) {
  if (!std::isfinite(gain.seconds)) return "not reached";
  return (gain.is_bound ? "at least " : "") + ratio_text(gain.ratio);
}

// --- overview
// -----------------------------------------------------------------------------------------------------

std::string overview(const BenchResults& results) {
  std::vector<std::string> methods;
  for (const BenchScene& scene : results.scenes)
    for (const BenchSeries& series : scene.series)
      if (std::find(methods.begin(), methods.end(), series.method) == methods.end())
        methods.push_back(series.method);
  if (methods.empty()) return {};
  std::vector<std::string> heads{"scene", "relMSE of path", "its CPU s"};
  for (const std::string& method : methods) heads.push_back(escape_html(method));
  Table table(
      "How many times sooner than path a method has the relMSE that path ends with (CPU time of all threads, "
      "pass one included, between two points along the line of logarithms)",
      heads);
  std::vector<std::vector<double>> ratios(methods.size());
  for (const BenchScene& scene : results.scenes) {
    const BenchSeries* truth = truth_of(scene);
    if (truth == nullptr) continue;
    std::vector<std::string> cells{number_text(truth->points.back().relmse, 3),
                                   number_text(truth->points.back().time.cpu_seconds, 3)};
    for (std::size_t m = 0; m < methods.size(); ++m) {
      std::string cell = "-";
      for (const BenchSeries& series : scene.series)
        if (series.method == methods[m] && !series.points.empty()) {
          const Gain gain = gain_of(series, *truth);
          if (std::isfinite(gain.seconds)) ratios[m].push_back(gain.ratio);
          cell = gain_text(gain);
        }
      cells.push_back(cell);
    }
    table.row(escape_html(scene.name), cells);
  }
  std::vector<std::string> means{"", ""};
  for (const std::vector<double>& list : ratios) {
    double sum = 0.0;
    for (const double ratio : list) sum += std::log(ratio);
    means.push_back(list.empty() ? "-"
                                 : ratio_text(std::exp(sum / static_cast<double>(list.size()))) + " (" +
                                       std::to_string(list.size()) + ")");
  }
  table.row("geometric mean (scenes)", means);
  return "<h2>Time to error</h2>\n" + table.finish();
}

// --- one scene
// ----------------------------------------------------------------------------------------------------

std::string plots(const BenchScene& scene) {
  LogPlot by_time{"CPU seconds (pass one included)", "relMSE", "relMSE against CPU seconds, by method", {}};
  LogPlot by_samples{"samples a pixel", "relMSE", "relMSE against samples a pixel, by method", {}};
  for (const BenchSeries& series : scene.series) {
    PlotLine time{series.method, {}}, samples{series.method, {}};
    for (const SeriesPoint& p : series.points) {
      time.points.emplace_back(p.time.cpu_seconds, p.relmse);
      samples.points.emplace_back(p.samples_per_pixel, p.relmse);
    }
    by_time.lines.push_back(time);
    by_samples.lines.push_back(samples);
  }
  return "<div class=\"pictures\"><figure>" + log_plot_svg(by_time) +
         "<figcaption>error against time</figcaption></figure>\n<figure>" + log_plot_svg(by_samples) +
         "<figcaption>error against samples</figcaption></figure></div>\n";
}

std::string last_points(const BenchScene& scene) {
  Table table(
      "At the end of the budget, means over the seeds. relMSE = bias<sup>2</sup> + variance, by how the seeds "
      "differ; the reference's own error is taken off. bias<sup>2</sup> may be negative where there is none",
      {"method", "samples", "seconds", "CPU s", "pass one", "million rays", "memory MB", "relMSE",
       "bias<sup>2</sup>", "variance", "MSE", "SMAPE", "FLIP", "energy R G B"});
  for (const BenchSeries& series : scene.series) {
    if (series.points.empty()) continue;
    const SeriesPoint& p = series.points.back();
    std::size_t memory = 0;
    for (const BenchRun& run : series.runs) memory = std::max(memory, run.memory_bytes);
    table.row(escape_html(series.method),
              {std::to_string(p.samples_per_pixel), number_text(p.time.seconds, 3),
               number_text(p.time.cpu_seconds, 3),
               number_text(p.time.seconds > 0 ? 100.0 * p.pass_one.seconds / p.time.seconds : 0.0, 2) + " %",
               p.rays > 0 ? number_text(1e-6 * static_cast<double>(p.rays), 3) : "-",
               memory > 0 ? number_text(1e-6 * static_cast<double>(memory), 3) : "-", number_text(p.relmse, 3),
               number_text(p.bias2, 2), number_text(p.variance, 3), number_text(p.mse, 3),
               number_text(p.smape, 3), number_text(p.flip, 3),
               number_text(p.energy_ratio.x, 4) + " " + number_text(p.energy_ratio.y, 4) + " " +
                   number_text(p.energy_ratio.z, 4)});
  }
  return table.finish();
}

std::string figure(const Image& image, const std::string& alt, const std::string& caption) {
  const int width = image.width >= 200 ? image.width : image.width * std::max(1, 256 / image.width);
  return "<figure><img src=\"" + png_uri(image) + "\" width=\"" + std::to_string(width) + "\" alt=\"" +
         escape_html(alt) + "\"><figcaption>" + escape_html(caption) + "</figcaption></figure>\n";
}

Image shown(Image picture, const DisplayTransform& display) {
  Image image(picture.width, picture.height, {"R", "G", "B"});
  const std::vector<C3f> colors = rgb_pixels(picture);
  for (std::size_t i = 0; i < colors.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) image.pixels[3 * i + c] = colors[i][static_cast<int>(c)];
  display.apply(image.pixels);
  return image;
}

std::string pictures(const BenchScene& scene, const DisplayTransform& display) {
  std::string html = "<div class=\"pictures\">\n" +
                     figure(shown(scene.reference.picture, display), "reference of " + scene.name, "reference");
  float most = 0.0f;  // one scale for all maps of a scene, so that they can be compared
  for (const BenchSeries& series : scene.series)
    most = std::max(most, quantile_of_magnitude(series.difference, 0.99));
  for (const BenchSeries& series : scene.series) {
    if (series.points.empty() || series.picture.pixels.empty()) continue;
    html += figure(shown(series.picture, display), series.method + " of " + scene.name,
                   series.method + ", one seed");
    html += figure(colored(series.difference, scene.width, scene.height, -most, most, diverging_colors()),
                   "error map of " + series.method,
                   series.method + ", mean of the seeds: (t - r) / sqrt(r^2 + 0.01), blue " +
                       number_text(-most, 2) + " to red " + number_text(most, 2));
  }
  return html + "</div>\n";
}

std::string pass_one_table(const BenchScene& scene) {
  if (scene.pass_one.empty()) return {};
  Table table(
      "The radiosity pass alone. relMSE and energy are those of the bare solution as the camera sees it, so "
      "that "
      "they hold what elements of this size cannot show",
      {"solver", "form factors", "elements", "links", "iterations", "million rays", "seconds", "CPU s",
       "memory MB", "error bound", "relMSE", "energy R G B"});
  for (const PassOneResult& r : scene.pass_one)
    table.row(escape_html(r.solver),
              {escape_html(r.form_factors), std::to_string(r.stats.elements), std::to_string(r.stats.links),
               std::to_string(r.stats.iterations), number_text(1e-6 * static_cast<double>(r.stats.rays), 3),
               number_text(r.time.seconds, 3), number_text(r.time.cpu_seconds, 3),
               r.memory_bytes > 0 ? number_text(1e-6 * static_cast<double>(r.memory_bytes), 3) : "-",
               number_text(r.stats.error_bound, 2), number_text(r.relmse, 3),
               number_text(r.energy_ratio.x, 4) + " " + number_text(r.energy_ratio.y, 4) + " " +
                   number_text(r.energy_ratio.z, 4)});
  return table.finish();
}

std::string scene_section(const BenchScene& scene, const DisplayTransform& display) {
  const BenchReference& r = scene.reference;
  std::string html = "<section><h2>" + escape_html(scene.name) + "</h2>\n<p class=\"quiet\">" +
                     escape_html(scene.file) + ", " + std::to_string(scene.width) + "x" +
                     std::to_string(scene.height) + ", " + std::to_string(scene.triangles) +
                     " triangles, fingerprint " + escape_html(scene.fingerprint) + ". Reference: path, " +
                     number_text(r.samples_per_pixel, 6) + " samples a pixel, " + number_text(r.seconds, 3) +
                     " s" + (r.was_cached ? " (kept from an earlier run)" : "") + "; its own relMSE is " +
                     number_text(r.relmse, 3) + ", and is taken off.</p>\n";
  for (const std::string& note : scene.notes) html += "<p class=\"quiet\">" + escape_html(note) + "</p>\n";
  if (!scene.series.empty()) html += plots(scene) + last_points(scene) + pictures(scene, display);
  return html + pass_one_table(scene) + "</section>\n";
}

}  // namespace

std::string bench_page(const BenchResults& results, const DisplayTransform& display) {
  std::string body = "<h1>twopass bench</h1>\n<p class=\"quiet\">" + escape_html(results.command) + "<br>\n" +
                     escape_html(results.machine) + "<br>\n" + escape_html(results.versions) + "</p>\n";
  if (!results.is_complete)
    body += "<p class=\"lead\">Not complete: this is what there was when it ended.</p>\n";
  body +=
      "<p>Each method renders the scene with doubling numbers of samples, through a box filter, until its time "
      "is "
      "up; each seed anew. relMSE is the mean over pixels and channels of d<sup>2</sup> / (r<sup>2</sup> + "
      "0.01), "
      "d = t - r; a slope of -1 is what independent samples have. A biased method levels off at its "
      "bias<sup>2</sup>.</p>\n";
  body += overview(results);
  for (const BenchScene& scene : results.scenes) body += scene_section(scene, display);
  return html_document("twopass bench", body, {});
}

}  // namespace twopass
