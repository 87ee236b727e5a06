// Coloured meshes in files that viewers and modellers read.
#pragma once

#include <filesystem>
#include <span>

#include "radiosity/display_mesh.h"

namespace twopass {

/// Binary little-endian PLY: x y z (float), red green blue (8 bits, sRGB, as Blender and MeshLab take them);
/// the exposure is in a comment. Written atomically. Throws Error.
void write_ply(const std::filesystem::path& path, const DisplayMesh& mesh);

/// Binary glTF 2.0: one node a shape, under its name, with one primitive a side, of POSITION and COLOR_0
/// (float, linear), under an unlit material that is seen from the front only; the exposure is in `extras` of
/// the asset. Written atomically. REQUIRES: the shapes that the mesh was made of. Throws Error, also beyond 4
/// GB.
void write_glb(const std::filesystem::path& path, const DisplayMesh& mesh, std::span<const Shape> shapes);

}  // namespace twopass
