// Mitsuba XML scenes, versions 0.4 to 3.x.
#pragma once

#include <filesystem>

#include "render/load/load.h"

namespace twopass {

/// Loads a file: shapes obj, rectangle, cube, sphere; bsdfs diffuse, twosided, conductor, dielectric; emitters
/// area and constant; a perspective sensor; filters box, tent, gaussian. Throws Error with file:line, listing
/// what is supported, for every other plugin and for every property that a plugin does not know.
LoadedScene load_mitsuba_scene(const std::filesystem::path& path, const Definitions& definitions,
                               const TextureOptions& textures = {});

}  // namespace twopass
