// The node hierarchy of a glTF scene, flattened: what hangs in it, and where.
#pragma once

#include <string>
#include <vector>

#include "render/core/types.h"
#include "render/load/gltf_document.h"

namespace twopass {

/// A node that holds something, in world coordinates.
struct GltfPlace {
  std::size_t node;  ///< index into the model's nodes
  M44d to_world;     ///< row vectors (Imath): p_world = p_node * to_world
};

/// The nodes of the default scene, or of the first, or all of them where the file has no scenes: parents before
/// children, in the file's order. Throws Error for a node that hangs in two places or in itself, for indices
/// that lead nowhere, and for transforms that are not finite.
std::vector<GltfPlace> gltf_places(const GltfDocument& document);

/// A name for errors and shapes: the node's, or "node 3".
std::string name_of_node(const GltfDocument& document, std::size_t node);

}  // namespace twopass
