#include "render/commands/scene_options.h"

#include "render/core/error.h"
#include "render/load/mitsuba_emitters.h"

namespace twopass {

namespace {

Definitions parse_definitions(const std::vector<std::string>& texts) {
  Definitions definitions;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      throw Error("-D " + text, "not of the form name=value", "write for example -D spp=64");
    definitions[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return definitions;
}

}  // namespace

void SceneOptions::add_to(CLI::App& command) {
  command.add_option("scene", file, "Scene: Mitsuba XML (.xml), Wavefront (.obj) or glTF 2.0 (.gltf, .glb)")->required();
  command.add_option("-D", definitions, "Value of a parameter of a Mitsuba scene, name=value (repeatable)")
      ->allow_extra_args(false);
}

void SceneOptions::add_sky_to(CLI::App& command) {
  CLI::Option* constant =
      command.add_option("--sky", sky, "Constant radiance of the sky, R,G,B, for scenes that have none")
          ->delimiter(',')
          ->expected(3)
          ->check(CLI::NonNegativeNumber);
  command.add_option("--envmap", envmap, "Picture of the surroundings by latitude and longitude, +y up")
      ->excludes(constant);
}

void SceneOptions::add_view_to(CLI::App& command) {
  command.add_option("--camera", camera, "Camera: origin, target and up, ox,oy,oz,tx,ty,tz,ux,uy,uz")
      ->delimiter(',')
      ->expected(9);
  command.add_option("--fov", fov_degrees, "Horizontal field of view of the camera, degrees")
      ->check(CLI::Range(1e-3, 179.9));
}

LoadedScene SceneOptions::load(const Console& console, Framing framing) const {
  LoadedScene loaded = load_scene(file, parse_definitions(definitions));
  for (const std::string& note : loaded.notes) console.note(note);
  SceneDescription& scene = loaded.scene;
  if (!sky.empty()) scene.environment = Environment(C3f(sky[0], sky[1], sky[2]));
  if (!envmap.empty()) scene.environment = read_environment_map(envmap, {});
  if (!camera.empty()) {
    const auto vector = [&](int i) { return V3d(camera[i], camera[i + 1], camera[i + 2]); };
    const CameraDescription previous = scene.camera.value_or(CameraDescription{});
    scene.camera = previous;
    scene.camera->to_world = look_at(vector(0), vector(3), vector(6), "--camera");
  } else if (!scene.camera && framing == Framing::automatic) {
    scene.camera = framing_camera(bounds_of(scene.shapes));
    console.note(file + ": no camera; framing the scene from the front (--camera overrides)");
  }
  if (fov_degrees && scene.camera) {
    scene.camera->fov_degrees = *fov_degrees;
    scene.camera->fov_axis = FovAxis::x;
  }
  return loaded;
}

}  // namespace twopass
