// A glTF 2.0 file (.gltf or .glb) as a scene. Knows no XML.
#pragma once

#include <filesystem>

#include "render/load/load.h"

namespace twopass {

/// Loads the default scene: a shape for each primitive of each node's mesh, named after the node or the mesh
/// ("node:material" where the mesh has several), the first camera, punctual lights. Everything stands in its
/// default pose: animations, skins and morph targets do nothing. Points and lines are left out with a note, as
/// are triangles with indices out of range or coordinates that are not finite. Throws Error naming the element
/// of the file. Memory, but for decoded
/// images: at most about 300 times the bytes of the file and of the buffers that it names, and 100 MB.
LoadedScene load_gltf_scene(const std::filesystem::path& path, const TextureOptions& textures);

}  // namespace twopass
