// KHR_lights_punctual to our lights.
//
// Intensities stay the numbers that the file has: candela become W/sr, lux W/m2. Emissive surfaces, which the
// specification measures in candela per square metre, are read in the same way, so that a file's lights and
// surfaces keep their proportions. (Blender's exporter multiplies lights, not surfaces, by 683 lm/W unless its
// lighting mode is "Unitless".)
#pragma once

#include <string>
#include <vector>

#include "render/load/gltf_nodes.h"
#include "render/load/notes.h"
#include "render/scene/punctual_light.h"

namespace twopass {

/// The lights of all places; `names` receives the names of their nodes. Throws Error for values that make no
/// light.
std::vector<PunctualLight> read_gltf_lights(const GltfDocument& document, const std::vector<GltfPlace>& places,
                                            Notes& notes, std::vector<std::string>& names);

}  // namespace twopass
