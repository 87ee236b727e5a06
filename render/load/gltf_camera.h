// Cameras of glTF nodes.
#pragma once

#include <optional>

#include "render/load/gltf_nodes.h"
#include "render/load/load.h"

namespace twopass {

/// The camera of the first of the places that has one; nothing when none has. Sets the picture's proportions
/// when the camera has some, keeping the height. Throws Error for values that make no picture.
std::optional<CameraDescription> read_gltf_camera(const GltfDocument& document,
                                                  const std::vector<GltfPlace>& places, FileSettings& settings,
                                                  Notes& notes);

/// The axes of a node's coordinates in the world, unit and perpendicular, for what must not be scaled: y leans
/// towards the node's y, z points along the node's z. Throws Error at the node when it has no such axes.
struct GltfAxes {
  V3d x, y, z;
};
GltfAxes axes_of(const GltfPlace& place, const GltfDocument& document);

}  // namespace twopass
