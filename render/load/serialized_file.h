// Mitsuba's compressed binary meshes.
#pragma once

#include <filesystem>

#include "render/scene/shape.h"

namespace twopass {

struct SerializedMesh {
  Mesh mesh;                  ///< with its normals and colours ("vertex_color"), if it has any
  bool face_normals = false;  ///< the file asks for flat triangles
};

/// Mesh number `index` of a file of version 3 or 4. Memory is bounded by what the compressed data really holds.
/// Throws Error naming the file and the offset of the mesh.
SerializedMesh read_serialized(const std::filesystem::path& path, int index);

}  // namespace twopass
