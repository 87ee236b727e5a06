// Coloured meshes in files that viewers and modellers read.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>
#include <vector>

#include "radiosity/display_mesh.h"

namespace twopass {

/// Binary little-endian PLY: x y z (float), red green blue (8 bits, sRGB, as Blender and MeshLab take them);
/// the exposure is in a comment. Written atomically. Throws Error.
void write_ply(const std::filesystem::path& path, const DisplayMesh& mesh);

/// Binary glTF 2.0: one node a shape, under its name, with one primitive a side, of POSITION and COLOR_0
/// (float, linear), under an unlit material that is seen from the front only; the exposure is in `extras` of
/// the asset. A node of its own holds the scene's camera, if that is a perspective one without flip. REQUIRES:
/// the scene that the mesh was made of. Throws Error at `where` beyond 4 GB.
std::vector<std::byte> glb_of(const DisplayMesh& mesh, const Scene& scene, std::string_view where);
/// The same in a file, written atomically. Throws Error.
void write_glb(const std::filesystem::path& path, const DisplayMesh& mesh, const Scene& scene);

}  // namespace twopass
