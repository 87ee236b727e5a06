#include "render/bench/subject.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "radiosity/scene_fingerprint.h"
#include "render/core/error.h"
#include "render/scene/data_hash.h"

namespace twopass {

namespace fs = std::filesystem;

namespace {

std::string name_of(const fs::path& file) {
  const std::string stem = file.stem().string();
  const std::string folder = fs::absolute(file).parent_path().filename().string();
  return stem == "scene" && !folder.empty() ? folder : stem;
}

V2i size_of(const FileSettings& settings, int longer_side) {
  const double scale = static_cast<double>(longer_side) / std::max(settings.width, settings.height);
  const auto scaled = [&](int pixels) { return std::max(1, static_cast<int>(std::lround(pixels * scale))); };
  return {scaled(settings.width), scaled(settings.height)};
}

}  // namespace

BenchSubject::BenchSubject(const fs::path& file_, LoadedScene loaded, int longer_side)
    : name(name_of(file_)),
      file(file_),
      limits{.max_depth = loaded.settings.max_depth,
             .rr_depth = loaded.settings.rr_depth,
             .hide_emitters = loaded.settings.hide_emitters},
      width(size_of(loaded.settings, longer_side).x),
      height(size_of(loaded.settings, longer_side).y),
      needs(needs_of(loaded.scene)),
      camera_description(*loaded.scene.camera),
      camera(camera_description, width, height),
      scene(std::move(loaded.scene)) {
  if (!needs.light)
    throw Error(file.string(), "it has no light, there is nothing to measure", "name a scene with a light");
  if (scene.has_textures()) cone = sample_cone(camera, width, height, 1);
}

std::string BenchSubject::fingerprint() const {
  DataHash hash;
  hash.add(scene_fingerprint(scene));
  const auto add = [&](double x) { hash.add(std::bit_cast<std::uint64_t>(x)); };
  const CameraDescription& c = camera_description;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k) add(c.to_world[i][k]);
  for (const double x : {c.fov_degrees, c.principal_point_offset.x, c.principal_point_offset.y,
                         c.aperture_radius, c.focus_distance, c.near_clip, c.far_clip})
    add(x);
  for (const int n : {static_cast<int>(c.fov_axis), static_cast<int>(c.projection), width, height,
                      limits.max_depth, static_cast<int>(limits.hide_emitters)})
    hash.add(static_cast<std::uint64_t>(n));
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash.value()));
  return text;
}

std::vector<fs::path> gallery_scenes() {
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  const fs::path places[] = {program.parent_path() / "share" / "twopass" / "scenes",
                             fs::path(TWOPASS_SOURCE_DIR) / "scenes"};
  for (const fs::path& place : places) {
    std::vector<fs::path> scenes;
    for (const auto& entry : fs::directory_iterator(place, ignored))
      if (fs::exists(entry.path() / "scene.xml", ignored)) scenes.push_back(entry.path() / "scene.xml");
    std::sort(scenes.begin(), scenes.end());
    if (!scenes.empty()) return scenes;
  }
  throw Error("scenes", "there are none in " + places[0].string() + " nor in " + places[1].string(),
              "name the scenes to measure");
}

}  // namespace twopass
