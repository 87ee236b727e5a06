#include "render/load/load.h"

#include "render/core/error.h"
#include "render/load/load_gltf_scene.h"
#include "render/load/load_obj_scene.h"
#include "render/load/mitsuba_scene.h"
#include "render/load/text_file.h"

namespace twopass {

LoadedScene load_scene(const std::filesystem::path& path, const Definitions& definitions,
                       const TextureOptions& textures, bool ignore_unsupported) {
  // A folder called "x.obj" or "x" is first of all a folder; say that before talking about extensions.
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw Error(path.string(), "this is a folder", "name a scene file in it");
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".xml") return load_mitsuba_scene(path, definitions, textures, ignore_unsupported);
  const bool is_obj = extension == ".obj", is_gltf = extension == ".gltf" || extension == ".glb";
  if ((is_obj || is_gltf) && !definitions.empty())
    throw Error("-D " + definitions.begin()->first, "only Mitsuba's scenes have parameters", "leave it out");
  if (is_obj) return load_obj_scene(path, textures);
  if (is_gltf) return load_gltf_scene(path, textures);
  throw Error(path.string(), "unknown scene format '" + extension + "'",
              "supported: .xml (Mitsuba 0.4 to 3.x), .obj (Wavefront), .gltf and .glb (glTF 2.0)");
}

}  // namespace twopass
