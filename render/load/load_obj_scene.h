// A Wavefront OBJ file with its MTL libraries as a scene. Knows no XML.
#pragma once

#include <filesystem>

#include "render/load/load.h"

namespace twopass {

/// Loads a file: a shape for each pair of object or group and material, named after the group ("group:material"
/// where the group has several), or after the material or the file where there is no group. No camera, no
/// settings. Faces without normals are smooth
/// within a smoothing group, else flat. Materials that no library defines are grey (0.5), with a note.
/// Throws Error with file:line.
LoadedScene load_obj_scene(const std::filesystem::path& path, const TextureOptions& textures = {});

}  // namespace twopass
