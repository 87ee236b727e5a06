// <emitter> elements that belong to no shape: punctual lights and environments.
#pragma once

#include <filesystem>
#include <variant>

#include "render/load/mitsuba_textures.h"
#include "render/scene/environment.h"
#include "render/scene/punctual_light.h"

namespace twopass {

/// Reads `point`, `spot`, `directional`, `projector`, `constant`, `envmap` and `sunsky` with Mitsuba 3's
/// parameters; `point` also takes `ies_file` (L22). Throws Error with file:line.
std::variant<PunctualLight, Environment> read_mitsuba_emitter(const XmlNode& node, const MitsubaTree& tree,
                                                              MitsubaTextures& textures);

/// The light group of such an element: its `light_group`, else its id, else "".
std::string light_group_of(const XmlNode& node, const MitsubaTree& tree);

/// A picture by latitude and longitude as environment. Throws Error.
Environment read_environment_map(const std::filesystem::path& path, const EnvironmentMapOptions& options);

}  // namespace twopass
