#include "render/statistics.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "render/image/atomic_file.h"
#include "render/version.h"

namespace twopass {

namespace {

using nlohmann::ordered_json;

// JSON has no infinity: what was not estimated is null.
ordered_json number_or_null(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json radiosity_json(const std::optional<RadiosityStats>& stats) {
  if (!stats) return nullptr;
  return {{"solver", stats->solver},
          {"form_factors", stats->form_factors},
          {"elements", stats->elements},
          {"links", stats->links},
          {"iterations", stats->iterations},
          {"rays", stats->rays},
          {"residual", number_or_null(stats->residual)},
          {"error_bound", number_or_null(stats->error_bound)},
          {"closure_error", number_or_null(stats->closure_error)},
          {"memory_bytes", stats->memory_bytes}};
}

ordered_json bias_json(const std::optional<Certificate>& bias) {
  if (!bias) return nullptr;
  return {{"mean", bias->mean},
          {"ci95", number_or_null(bias->ci95)},
          {"samples", bias->samples},
          {"rays", bias->counts.rays + bias->counts.shadow_rays}};
}

ordered_json place_json(const std::optional<SamplePlace>& place) {
  if (!place) return nullptr;
  return {{"pixel", {place->pixel.x, place->pixel.y}}, {"sample", place->sample}};
}

ordered_json render_json(const RenderStatistics& s) {
  if (!s.is_render) return nullptr;
  const double pixels = static_cast<double>(s.width) * s.height;
  return {{"integrator", s.integrator},
          {"width", s.width},
          {"height", s.height},
          {"spp", static_cast<double>(s.samples) / pixels},
          {"samples", s.samples},
          {"rays", s.outcome.counts.rays},
          {"shadow_rays", s.outcome.counts.shadow_rays},
          {"escaped_rays", s.outcome.counts.escaped_rays},
          {"non_finite_samples", s.outcome.non_finite_samples},
          {"first_non_finite", place_json(s.outcome.first_non_finite)},
          {"relative_error", number_or_null(s.relative_error)},
          {"relative_error_bound", number_or_null(s.relative_error_bound)},
          {"stop_reason", s.outcome.stop_reason},
          {"pixels_stopped_early", s.outcome.pixels_stopped_early},
          {"sampler", s.sampler},
          {"clamped", s.clamped.empty() ? ordered_json(nullptr) : ordered_json(s.clamped)},
          {"bias", bias_json(s.bias)}};
}

}  // namespace

void RenderStatistics::count(const Scene& scene) {
  triangles = 0;
  for (const Shape& shape : scene.shapes())
    if (const Mesh* mesh = mesh_of(shape.geometry)) triangles += mesh->triangles.size();
  emitters = scene.lights().count();
}

void write_statistics(const std::filesystem::path& path, const RenderStatistics& s) {
  ordered_json skipped = ordered_json::array();
  for (const Skipped& entry : s.skipped) skipped.push_back({{"what", entry.what}, {"why", entry.why}});
  const ordered_json json = {
      {"program", {{"name", "twopass"}, {"version", program_version}}},
      {"scene",
       {{"file", s.scene_file}, {"triangles", s.triangles}, {"emitters", s.emitters}, {"skipped", skipped}}},
      {"seconds",
       {{"load", s.load.seconds},
        {"build", s.build.seconds},
        {"radiosity", s.radiosity_time.seconds},
        {"render", s.render.seconds},
        {"write", s.write.seconds},
        {"total", s.total.seconds}}},
      {"cpu_seconds",
       {{"radiosity", s.radiosity_time.cpu_seconds},
        {"render", s.render.cpu_seconds},
        {"total", s.total.cpu_seconds}}},
      {"radiosity", radiosity_json(s.radiosity)},
      {"render", render_json(s)},
      {"peak_memory_bytes", peak_memory_bytes()},
      {"threads", s.threads},
      {"seed", s.seed}};
  const std::string text = json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
  write_atomically(path, std::as_bytes(std::span(text)));
}

}  // namespace twopass
