#include "render/render_identity.h"

#include <bit>
#include <cstdio>

#include "radiosity/scene_fingerprint.h"
#include "radiosity/solution_file.h"
#include "render/scene/data_hash.h"
#include "render/version.h"

namespace twopass {
namespace {

std::string hex(std::uint64_t number) {
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(number));
  return text;
}

// Different floats have different texts.
std::string text(float number) {
  char result[32];
  std::snprintf(result, sizeof result, "%.9g", static_cast<double>(number));
  return result;
}

std::string text(const V2i& v) { return std::to_string(v.x) + "x" + std::to_string(v.y); }

std::string text(const FilmLayout& layout) {
  std::string names;
  for (const std::string& channel : layout.channels()) names += (names.empty() ? "" : " ") + channel;
  return names;
}

std::string text(const Filter& filter) {
  return std::string(name_of_value<FilterKind>(filter_names(), filter.kind)) + " " + text(filter.radius) + " " +
         text(filter.stddev) + " " + text(filter.b) + " " + text(filter.c);
}

std::uint64_t fingerprint(const CameraDescription& camera) {
  DataHash hash;
  const auto add = [&](double x) { hash.add(std::bit_cast<std::uint64_t>(x)); };
  for (const auto& row : camera.to_world.x)
    for (const double x : row) add(x);
  for (const double x : {camera.fov_degrees, camera.principal_point_offset.x, camera.principal_point_offset.y,
                         camera.aperture_radius, camera.focus_distance, camera.near_clip, camera.far_clip})
    add(x);
  hash.add(static_cast<std::uint64_t>(camera.fov_axis));
  hash.add(static_cast<std::uint64_t>(camera.projection));
  return hash.value();
}

}  // namespace

RenderIdentity identity_of(const IdentityFacts& f) {
  const PathLimits& limits = f.limits;
  RenderIdentity identity{.version = program_version,
                          .scene = hex(scene_fingerprint(f.scene)),
                          .solution = f.solution != nullptr ? hex(solution_fingerprint(*f.solution)) : "",
                          .settings = {}};
  identity.settings = {
      {"integrator", std::string(name_of_value<IntegratorKind>(integrator_names, f.integrator))},
      {"size", text(f.size)},
      {"window", text(f.window.size) + " at " + std::to_string(f.window.corner.x) + "," +
                     std::to_string(f.window.corner.y)},
      {"camera", hex(fingerprint(f.camera))},
      {"filter", text(f.filter)},
      {"sampler", std::string(name_of_value<SamplerKind>(sampler_names, f.sampler))},
      {"seed", std::to_string(f.seed)},
      {"max depth", std::to_string(limits.max_depth)},
      {"roulette depth", std::to_string(limits.rr_depth)},
      {"hiding of emitters", limits.hide_emitters ? "on" : "off"},
      {"clamp of direct light", text(limits.clamp_direct)},
      {"clamp of indirect light", text(limits.clamp_indirect)},
      {"footprint of textures", text(f.cone.width) + " " + text(f.cone.spread) + " " + text(f.cone.share)},
      {"list of channels", text(f.layout)}};
  // Its grid depends on how many samples there are in all.
  if (f.sampler == SamplerKind::stratified)
    identity.settings.emplace_back("number of samples a pixel", std::to_string(f.strata));
  return identity;
}

}  // namespace twopass
