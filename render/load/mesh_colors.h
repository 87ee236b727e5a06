// Textures that are stored with meshes: materials get those of the mesh that they are on.
#pragma once

#include <string>

#include "render/scene/scene.h"

namespace twopass {

/// Gives a shape whose material or radiance looks at attributes of its mesh (MeshColors) a material of its own,
/// to which they are bound; others stay as they are. Removes the mesh's attributes, which have then been used.
/// Throws Error at `where` when the mesh has no attribute of that name, or the shape is no mesh.
void bind_mesh_colors(Shape& shape, std::vector<Material>& materials, const std::string& where);

}  // namespace twopass
