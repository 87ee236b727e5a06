// Mitsuba XML scenes, versions 0.4 to 3.x.
#pragma once

#include <filesystem>

#include "render/load/load.h"

namespace twopass {

/// Loads a file. Throws Unsupported with file:line, listing what is supported, for every plugin that we lack
/// and for every property that a plugin does not know; with `ignore_unsupported` those are left out: objects
/// with all that refers to them, bsdfs and textures are replaced by grey ones.
LoadedScene load_mitsuba_scene(const std::filesystem::path& path, const Definitions& definitions,
                               const TextureOptions& textures = {}, bool ignore_unsupported = false);

}  // namespace twopass
