#include "render/commands/scene_options.h"

#include <algorithm>

#include "render/core/error.h"
#include "render/load/mitsuba_emitters.h"
#include "render/scene/centred_scene.h"
#include "render/scene/duplicate_lamps.h"
#include "render/scene/mesh_facts.h"
#include "render/scene/room_view.h"

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

bool has_light(const SceneDescription& scene) {
  return !scene.environment.is_black() || !scene.punctual_lights.empty() ||
         std::ranges::any_of(scene.shapes, is_emitter);
}

// What a newcomer sees instead of a black picture of nothing, in words.
std::string addition_text(bool light, bool camera, bool is_room) {
  const std::string what = camera && light ? "no camera and no light: " : camera ? "no camera: " : "no light: ";
  std::string options = camera ? "--camera and --fov" : "";
  if (light) options += std::string(camera ? ", " : "") + "--sky or --envmap";
  std::string text;
  if (camera) text = is_room ? "a closed room, seen from one of its corners" : "all of it is framed";
  if (light)
    text += std::string(camera    ? ", "
                        : is_room ? "a closed room, "
                                  : "") +
            (is_room ? "under a lamp of our own" : "under a neutral sky");
  return what + text + " (" + options + " give another" + (camera && !light ? " view" : "") +
         (light ? ", --sky 0,0,0 none" : "") + ")";
}

void add_lamp(SceneDescription& scene, const RoomView& room) {
  Shape lamp;
  lamp.name = "lamp";
  lamp.geometry = room.lamp;
  lamp.material = static_cast<std::uint32_t>(scene.materials.size());
  lamp.radiance[front] = C3f(room.radiance);
  const Diffuse black{C3f(0.0f)};
  scene.materials.push_back(two_sided("lamp", black, black));
  scene.shapes.push_back(std::move(lamp));
}

}  // namespace

void SceneOptions::add_to(CLI::App& command) {
  command.add_option("scene", file, "Scene: Mitsuba XML (.xml), Wavefront (.obj) or glTF 2.0 (.gltf, .glb)")
      ->required();
  command.add_option("-D", definitions, "Value of a parameter of a Mitsuba scene, name=value (repeatable)")
      ->allow_extra_args(false);
  command.add_flag("--ignore-unsupported", ignore_unsupported,
                   "Leave out what the scene asks for and we lack, and say what that is");
  command
      .add_option_function<std::string>(
          "--missing-textures",
          [this](const std::string& name) {
            textures.missing =
                value_of_name<MissingTextures>(missing_textures_names, name, "--missing-textures", "way");
          },
          "What becomes of a texture whose file is not there: error (default) or pink")
      ->type_name("WAY");
  command
      .add_option(
          "--texture-memory", textures.memory_megabytes,
          "Memory that textures may take, MB; what does not fit is read tile by tile when it is looked at")
      ->check(CLI::Range(16, 1 << 20))
      ->capture_default_str();
}

void SceneOptions::add_sky_to(CLI::App& command) {
  CLI::Option* constant =
      command
          .add_option(
              "--sky", sky,
              "Constant radiance of the sky, R,G,B (default: the scene's; 1,1,1 where it has no light at all)")
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

LoadedScene SceneOptions::load(const Console& console, Additions additions,
                               const std::string& color_config) const {
  TextureOptions texture_options = textures;
  texture_options.color_config = color_config;
  LoadedScene loaded = load_scene(file, parse_definitions(definitions), texture_options, ignore_unsupported);
  for (const Skipped& entry : loaded.left_out) console.note("left out: " + entry.what + " (" + entry.why + ")");
  for (const std::string& note : loaded.notes) console.note(note);
  SceneDescription& scene = loaded.scene;
  if (additions != Additions::none) {
    if (const std::size_t duplicates = leave_out_duplicate_lamps(scene); duplicates > 0)
      console.note(file + ": triangles of lamps that stand there twice are left out (" +
                   std::to_string(duplicates) + " times)");
    scene = centred(std::move(scene));
  }
  if (!sky.empty()) scene.environment = Environment(C3f(sky[0], sky[1], sky[2]));
  if (!envmap.empty()) scene.environment = read_environment_map(envmap, {});
  const bool wants_light = additions != Additions::none && sky.empty() && envmap.empty() && !has_light(scene);
  const bool wants_camera = additions == Additions::light_and_camera && !scene.camera && camera.empty();
  std::optional<RoomView> room;
  if (wants_light || wants_camera) room = find_room_view(scene.shapes);
  if (wants_camera)
    scene.camera =
        room ? room->camera
             : framing_camera(bounds_of(scene.shapes),
                              faces_inward(scene.shapes) ? FramingView::front : FramingView::three_quarter);
  if (wants_light && room)
    add_lamp(scene, *room);
  else if (wants_light)
    scene.environment = Environment(C3f(1.0f));
  if (!camera.empty()) {
    const auto vector = [&](int i) { return V3d(camera[i], camera[i + 1], camera[i + 2]); };
    CameraDescription view = scene.camera ? scene.frame.to_world(*scene.camera) : CameraDescription{};
    view.projection = Projection::perspective;
    view.to_world = look_at(vector(0), vector(3), vector(6), "--camera");
    scene.camera = scene.frame.from_world(view);
  }
  if (fov_degrees && scene.camera) {
    scene.camera->projection = Projection::perspective;
    scene.camera->fov_degrees = *fov_degrees;
    scene.camera->fov_axis = FovAxis::x;
  }
  if (wants_light || wants_camera)
    console.note(file + ": " + addition_text(wants_light, wants_camera, room.has_value()));
  return loaded;
}

void note_tiled_textures(const Console& console, std::span<const TiledTexture> textures) {
  for (const TiledTexture& texture : textures) {
    if (const auto tiles = texture.image->unreadable_tiles(); tiles > 0)
      console.note(texture.name + ": " + std::to_string(tiles) +
                   " look-ups met tiles that cannot be read; they saw black");
    if (const auto bad = texture.image->not_finite(); bad > 0)
      console.note(texture.name + " holds " + std::to_string(bad) +
                   " values that are NaN or infinite; they read as 0");
  }
}

}  // namespace twopass
