#include "render/bench/cycles.h"

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "render/core/error.h"
#include "render/core/interrupt.h"
#include "render/image/atomic_file.h"
#include "render/image/exr.h"

extern char** environ;

namespace twopass {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

namespace {

constexpr char cycles_py[] =
#include "web/cycles.py.inc"
    ;

// Cycles samples lamps well only in scenes of a few units.
constexpr float size_in_blender = 4.0f;
constexpr int unlimited_bounces = 1024;

bool is_white(const C3f& c) { return c == C3f(1.0f); }

// What Cycles calls this side; null: it has no such thing.
ordered_json side_json(const MaterialSide& side, const C3f& radiance) {
  const auto color = [](const C3f& c) { return ordered_json{c.x, c.y, c.z}; };
  if (!side.is_uniform()) return nullptr;
  ordered_json json;
  if (const auto* diffuse = std::get_if<Diffuse>(&side.uniform())) {
    json = {{"kind", "diffuse"}, {"color", color(diffuse->reflectance)}};
  } else if (const auto* mirror = std::get_if<Conductor>(&side.uniform())) {
    if (!is_black(mirror->eta) || !is_white(mirror->k)) return nullptr;
    json = {{"kind", "mirror"}, {"color", color(mirror->specular_reflectance)}};
  } else if (const auto* glass = std::get_if<Dielectric>(&side.uniform())) {
    if (!is_white(glass->specular_reflectance) || !is_white(glass->specular_transmittance)) return nullptr;
    json = {{"kind", "glass"}, {"color", color(C3f(1.0f))}, {"ior", glass->eta}};
  } else {
    return nullptr;
  }
  json["radiance"] = color(radiance);
  return json;
}

// The horizontal field of view, radians.
double fov_x(const CameraDescription& camera, int width, int height) {
  const double aspect = static_cast<double>(width) / height;
  const double half = std::tan(0.5 * camera.fov_degrees * std::acos(-1.0) / 180.0);
  const double half_x = [&] {
    switch (camera.fov_axis) {
      case FovAxis::x:
        return half;
      case FovAxis::y:
        return half * aspect;
      case FovAxis::diagonal:
        return half * aspect / std::hypot(aspect, 1.0);
      case FovAxis::smaller:
        return aspect < 1.0 ? half : half * aspect;
      case FovAxis::larger:
        return aspect > 1.0 ? half : half * aspect;
    }
    return half;
  }();
  return 2.0 * std::atan(half_x);
}

template <class T>
void write_numbers(const fs::path& file, const std::vector<T>& numbers) {
  write_atomically(file, std::as_bytes(std::span(numbers)));
}

// Writes the scene and what to do with it.
void write_job(const BenchSubject& subject, const SeriesBudget& budget, int threads, const fs::path& folder) {
  const Box3f bounds = subject.scene.bounds();
  const float scale = size_in_blender / std::max({bounds.size().x, bounds.size().y, bounds.size().z});
  const V3f center = bounds.center();
  std::vector<float> positions;
  std::vector<std::uint32_t> triangles;
  ordered_json shapes = ordered_json::array();
  for (const Shape& shape : subject.scene.shapes()) {
    const Mesh& mesh = std::get<Mesh>(shape.geometry);
    const std::size_t first_position = positions.size() / 3, first_triangle = triangles.size() / 3;
    for (const V3f& p : mesh.positions)
      for (int axis = 0; axis < 3; ++axis) positions.push_back((p[axis] - center[axis]) * scale);
    for (const V3u& t : mesh.triangles) triangles.insert(triangles.end(), {t.x, t.y, t.z});
    const Material& material = subject.scene.description().materials[shape.material];
    shapes.push_back({{"positions", {first_position, positions.size() / 3}},
                      {"triangles", {first_triangle, triangles.size() / 3}},
                      {"sides",
                       {side_json(material.side[front], shape.radiance[front]),
                        side_json(material.side[back], shape.radiance[back])}}});
  }
  // Blender's cameras look along -z and have +x on the right; ours look along +z and have +x on the left. Its
  // matrices stand in columns.
  const CameraDescription& camera = subject.camera_description;
  const M44d& m = camera.to_world;
  ordered_json matrix = ordered_json::array();
  for (int row = 0; row < 3; ++row)
    matrix.push_back({-m[0][row], m[1][row], -m[2][row], (m[3][row] - center[row]) * scale});
  matrix.push_back({0, 0, 0, 1});
  const C3f sky = subject.scene.environment().constant().value_or(C3f(0.0f));
  const int depth = subject.limits.max_depth;
  const ordered_json job = {
      {"width", subject.width},
      {"height", subject.height},
      {"shapes", shapes},
      {"camera",
       {{"matrix", matrix},
        {"fov_x", fov_x(camera, subject.width, subject.height)},
        {"clip", {std::max(1e-5, camera.near_clip * scale), std::min(1e5, camera.far_clip * scale)}}}},
      {"sky", {sky.x, sky.y, sky.z}},
      {"bounces", depth < 0 ? unlimited_bounces : std::max(0, depth - 2)},
      {"threads", threads},
      {"seeds", budget.seeds},
      {"seconds", budget.seconds}};
  write_numbers(folder / "positions", positions);
  write_numbers(folder / "triangles", triangles);
  const std::string text = job.dump();
  write_atomically(folder / "job.json", std::as_bytes(std::span(text)));
  write_atomically(folder / "cycles.py", std::as_bytes(std::span(cycles_py, std::size(cycles_py) - 1)));
}

// Runs Blender on the job. False: it failed.
bool run_blender(const fs::path& folder, const std::function<void(double)>& report) {
  const std::string script = (folder / "cycles.py").string(), job = (folder / "job.json").string(),
                    log = (folder / "log").string();
  const char* arguments[] = {"blender",      "-b", "--factory-startup", "-P",
                             script.c_str(), "--", job.c_str(),         nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  pid_t child = 0;
  const int failed =
      posix_spawnp(&child, arguments[0], &actions, nullptr, const_cast<char* const*>(arguments), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return false;
  const Stopwatch stopwatch;
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (interrupt_requested()) {
      kill(child, SIGTERM);
      waitpid(child, &status, 0);
      return true;  // what it has done counts
    }
    if (report) report(stopwatch.seconds());
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string last_line(const fs::path& file) {
  std::ifstream in(file);
  std::string line, last = "it said nothing";
  while (std::getline(in, line))
    if (line.find_first_not_of(" \t\r") != std::string::npos) last = line;
  return last;
}

// A folder that is gone afterwards.
struct WorkFolder {
  explicit WorkFolder(const fs::path& parent)
      : path(fs::absolute(parent) / (".cycles-" + std::to_string(getpid()))) {
    std::error_code problem;
    fs::create_directories(path, problem);
    if (problem) throw Error(path.string(), problem.message(), "choose a folder that can be written");
  }
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  fs::path path;
};

}  // namespace

bool has_blender() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((fs::path(folder) / "blender").c_str(), X_OK) == 0) return true;
  return false;
}

std::string unfit_for_cycles(const BenchSubject& subject) {
  const SceneDescription& scene = subject.scene.description();
  const CameraDescription& camera = subject.camera_description;
  if (!scene.punctual_lights.empty()) return "it has lights without a surface";
  if (!scene.environment.is_black() && !scene.environment.constant()) return "its sky is not constant";
  if (camera.projection != Projection::perspective || camera.aperture_radius > 0.0 ||
      camera.principal_point_offset != V2d(0.0))
    return "its camera is no plain pinhole";
  if (M44d(camera.to_world).determinant() < 0.0) return "its camera is mirrored";
  if (subject.limits.hide_emitters) return "its lights are hidden";
  for (const Shape& shape : scene.shapes) {
    const auto* mesh = std::get_if<Mesh>(&shape.geometry);
    if (mesh == nullptr || !mesh->normals.empty()) return "not all of its shapes are faceted meshes";
    if (shape.radiance_texture) return "a light is textured";
    const Material& material = scene.materials[shape.material];
    if (side_json(material.side[front], C3f(0.0f)).is_null() ||
        side_json(material.side[back], C3f(0.0f)).is_null())
      return "not all of its surfaces are diffuse, mirrors or glass";
  }
  return {};
}

BenchSeries measure_cycles(const BenchSubject& subject, const BenchReference& reference,
                           const SeriesBudget& budget, int threads, const fs::path& folder,
                           const std::function<void(double)>& report) {
  const WorkFolder work(folder);
  write_job(subject, budget, threads, work.path);
  if (!run_blender(work.path, report))
    throw Error("blender", "it failed: " + last_line(work.path / "log"), "repair it, or give --no-peers");
  std::ifstream lines(work.path / "points.jsonl");
  std::optional<SeriesCollector> collector;
  std::size_t memory = 0;
  std::optional<std::uint32_t> seed;
  for (std::string line; std::getline(lines, line);) {
    const ordered_json json = ordered_json::parse(line, nullptr, false);
    if (json.is_discarded()) break;  // it was stopped while it wrote
    if (!collector)
      collector.emplace(subject.name, "Cycles " + json.at("version").get<std::string>(), reference);
    if (seed != json.at("seed").get<std::uint32_t>()) {
      if (seed) collector->end_run(memory);
      collector->begin_run(*(seed = json.at("seed").get<std::uint32_t>()));
    }
    memory = json.at("memory_bytes");
    collector->add({.samples_per_pixel = json.at("spp"),
                    .time = {json.at("seconds"), json.at("cpu_seconds")},
                    .pass_one = {}},
                   read_exr(work.path / json.at("file").get<std::string>()));
  }
  if (!collector) {
    if (interrupt_requested()) throw Interrupted{};
    throw Error("blender", "it rendered nothing: " + last_line(work.path / "log"),
                "repair it, or give --no-peers");
  }
  collector->end_run(memory);
  return collector->finish();
}

}  // namespace twopass
