#include "render/bench/results.h"

#include <cmath>
#include <cstdio>
#include <fstream>

#include <nlohmann/json.hpp>
#include <sys/utsname.h>

#include "render/version.h"

namespace twopass {

namespace {

using nlohmann::ordered_json;

ordered_json number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr); }
ordered_json triple(const C3d& c) { return {number(c.x), number(c.y), number(c.z)}; }

double share_of_pass_one(const BenchPoint& p) {
  return p.time.seconds > 0.0 ? p.pass_one.seconds / p.time.seconds : 0.0;
}

std::size_t memory_of(const BenchSeries& series) {
  std::size_t most = 0;
  for (const BenchRun& run : series.runs) most = std::max(most, run.memory_bytes);
  return most;
}

ordered_json point_json(const BenchPoint& p) {
  return {{"spp", p.samples_per_pixel},
          {"seconds", p.time.seconds},
          {"cpu_seconds", p.time.cpu_seconds},
          {"pass_one_seconds", p.pass_one.seconds},
          {"pass_one_cpu_seconds", p.pass_one.cpu_seconds},
          {"pass_one_share", share_of_pass_one(p)},
          {"rays", p.rays},
          {"relmse", number(p.relmse)},
          {"mse", number(p.mse)},
          {"smape", number(p.smape)},
          {"flip", number(p.flip)},
          {"energy_ratio", triple(p.energy_ratio)}};
}

ordered_json series_json(const BenchSeries& series) {
  ordered_json points = ordered_json::array(), runs = ordered_json::array();
  for (const SeriesPoint& point : series.points) {
    ordered_json json = point_json(point);
    json["bias2"] = number(point.bias2);
    json["variance"] = number(point.variance);
    points.push_back(json);
  }
  for (const BenchRun& run : series.runs) {
    ordered_json own = ordered_json::array();
    for (const BenchPoint& point : run.points) own.push_back(point_json(point));
    runs.push_back({{"seed", run.seed}, {"memory_bytes", run.memory_bytes}, {"points", own}});
  }
  return {{"method", series.method}, {"points", points}, {"runs", runs}};
}

ordered_json pass_one_json(const PassOneResult& r) {
  return {{"solver", r.solver},
          {"form_factors", r.form_factors},
          {"elements", r.stats.elements},
          {"links", r.stats.links},
          {"iterations", r.stats.iterations},
          {"rays", r.stats.rays},
          {"residual", number(r.stats.residual)},
          {"error_bound", number(r.stats.error_bound)},
          {"seconds", r.time.seconds},
          {"cpu_seconds", r.time.cpu_seconds},
          {"memory_bytes", r.memory_bytes},
          {"relmse", number(r.relmse)},
          {"energy_ratio", triple(r.energy_ratio)}};
}

// A field of RFC 4180.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
}

// Numbers between commas; those that are not known are empty.
void add_numbers(std::string& line, std::initializer_list<double> values) {
  for (const double value : values) {
    char text[32] = "";
    if (std::isfinite(value)) std::snprintf(text, sizeof text, "%.9g", value);
    line += std::string(",") + text;
  }
}

}  // namespace

std::string machine_text(int threads) {
  std::string model = "unknown processor";
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) {
      model = line.substr(line.find(':') + 2);
      break;
    }
  utsname system{};
  std::string text = model + ", " + std::to_string(threads) + (threads == 1 ? " thread" : " threads");
  if (uname(&system) == 0)
    text += std::string(", ") + system.sysname + " " + system.release + " " + system.machine;
  return text;
}

std::string versions_text() {
#ifdef __clang__
  const std::string compiler = std::string("clang ") + __clang_version__;
#else
  const std::string compiler = std::string("g++ ") + __VERSION__;
#endif
  return "twopass " + std::string(program_version) + ", " + compiler;
}

std::string results_json(const BenchResults& results) {
  ordered_json scenes = ordered_json::array();
  for (const BenchScene& scene : results.scenes) {
    ordered_json series = ordered_json::array(), pass_one = ordered_json::array();
    for (const BenchSeries& one : scene.series) series.push_back(series_json(one));
    for (const PassOneResult& one : scene.pass_one) pass_one.push_back(pass_one_json(one));
    scenes.push_back({{"name", scene.name},
                      {"file", scene.file},
                      {"fingerprint", scene.fingerprint},
                      {"size", {scene.width, scene.height}},
                      {"triangles", scene.triangles},
                      {"reference",
                       {{"integrator", "path"},
                        {"spp", scene.reference.samples_per_pixel},
                        {"seconds", scene.reference.seconds},
                        {"cached", scene.reference.was_cached},
                        {"own_relmse", number(scene.reference.relmse)},
                        {"own_mse", number(scene.reference.mse)}}},
                      {"series", series},
                      {"pass_one", pass_one},
                      {"notes", scene.notes}});
  }
  const ordered_json json = {{"program", {{"name", "twopass"}, {"version", program_version}}},
                             {"command", results.command},
                             {"machine", results.machine},
                             {"versions", results.versions},
                             {"threads", results.threads},
                             {"complete", results.is_complete},
                             {"scenes", scenes}};
  return json.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string results_csv(const BenchResults& results) {
  std::string text =
      "scene,method,seeds,spp,seconds,cpu_seconds,pass_one_seconds,pass_one_share,rays,memory_bytes,relmse,"
      "bias2,"
      "variance,mse,smape,flip,energy_r,energy_g,energy_b\n";
  for (const BenchScene& scene : results.scenes)
    for (const BenchSeries& series : scene.series)
      for (const SeriesPoint& p : series.points) {
        text += quoted(scene.name) + "," + quoted(series.method);
        add_numbers(text,
                    {static_cast<double>(p.runs), static_cast<double>(p.samples_per_pixel), p.time.seconds,
                     p.time.cpu_seconds, p.pass_one.seconds, share_of_pass_one(p), static_cast<double>(p.rays),
                     static_cast<double>(memory_of(series)), p.relmse, p.bias2, p.variance, p.mse, p.smape,
                     p.flip, p.energy_ratio.x, p.energy_ratio.y, p.energy_ratio.z});
        text += "\n";
      }
  return text;
}

std::string pass_one_csv(const BenchResults& results) {
  std::string text =
      "scene,solver,form_factors,elements,links,iterations,rays,seconds,cpu_seconds,memory_bytes,error_bound,"
      "relmse,"
      "energy_r,energy_g,energy_b\n";
  for (const BenchScene& scene : results.scenes)
    for (const PassOneResult& r : scene.pass_one) {
      text += quoted(scene.name) + "," + quoted(r.solver) + "," + quoted(r.form_factors);
      add_numbers(text, {static_cast<double>(r.stats.elements), static_cast<double>(r.stats.links),
                         static_cast<double>(r.stats.iterations), static_cast<double>(r.stats.rays),
                         r.time.seconds, r.time.cpu_seconds, static_cast<double>(r.memory_bytes),
                         r.stats.error_bound, r.relmse, r.energy_ratio.x, r.energy_ratio.y, r.energy_ratio.z});
      text += "\n";
    }
  return text;
}

}  // namespace twopass
