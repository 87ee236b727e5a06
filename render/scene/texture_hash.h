// Textures into hashes that tell scenes and lights apart.
#pragma once

#include "materials/texture.h"
#include "render/scene/data_hash.h"

namespace twopass {

/// Adds everything that look-ups depend on.
void add_texture(DataHash& hash, const Texture& texture);

}  // namespace twopass
