// Stanford PLY files to meshes.
#pragma once

#include <filesystem>

#include "render/load/notes.h"
#include "render/scene/shape.h"

namespace twopass {

/// The mesh of a file in the ascii or one of the binary formats: positions, normals (nx ny nz), texture
/// coordinates (u v, s t, texture_u texture_v), faces of any size, cut into triangles. Other properties become
/// attributes with the names and by the rules of Mitsuba: red green blue (or r g b) is "vertex_color", a run
/// like w_x w_y w_z "vertex_w", likewise "face_..."; a single number keeps its name. Integers are stored as [0,
/// 1] of their type and encoded in sRGB. Elements and lists that mean nothing to us are skipped. Memory is
/// bounded by the size of the file. Throws Error with file:line (ascii) or the offset in bytes.
Mesh read_ply(const std::filesystem::path& path, Notes& notes);

}  // namespace twopass
